// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "engine/maps/planar_move.h"
#include "perception/places/submap_surface.h"

namespace prospect {

/// How one submap lies on another one.
struct SubmapAlignment {
  PlanarMove move;  ///< of the one, onto the other's lattice
  /// Of its error (x, y, yaw) about the centre [m, m, rad], in the other's lattice.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int matched = 0;       ///< walls of the one that lie on walls of the other
  double agreement = 0;  ///< their share of those that lie where the other knows something
  double overlap = 0;    ///< share of the one's walls that do
};

/// Aligns the walls of one submap with those of another one, in the plane. The most likely place,
///   max over x = (x, y, yaw)  0.1 sum_i g_i(x) - (x - guess)^T spread^-1 (x - guess) / 2,
///   g_i = max(0, rho(0.15 m / sigma) - rho_i),   rho_i = log(1 + (n_i . (q_i - p_i))^2 / sigma^2),
/// q_i the wall of the one at the place of now, p_i the nearest wall of the other one that faces
/// alike and n_i its normal; as if every tenth wall was independent, as walls of one scan share its
/// error. Gauss-Newton, 15 iterations, over walls within a reach that is drawn in from 0.6 to
/// 0.15 m. Walls that the other one does not know count for nothing, so any part may overlap, seen
/// from anywhere. Begun from several places: from `guess`, and where that is less sure than 0.1 m,
/// from those around it, by twice its deviation, 0.5 m and 0.15 rad at most.
///
/// What is returned is what the walls say, without the guess: along each eigenvector of the Hessian
/// their likelihood, 0.1 sum_i (g_i - g) with g the mean at the most likely place, is walked 0.6 m
/// either way; mean m and variance v there with the guess, n and u of the guess alone,
///   information = 1 / v - 1 / u,      mean = (m / v - n / u) / information,
/// as in expectation propagation. So nothing is measured along a corridor, nor where walls repeat
/// themselves. Ends that are likely, too, widen it by how far they lie off. Besides, each direction
/// has (1 cm, 2 mrad): submaps are not stiff.
///
/// Nothing, if it cannot be decided: fewer than 60 walls match, or fewer than 0.6 of those that
/// could. Source: ours; a distance field as in Hector SLAM and voxgraph, the point-to-line error of
/// Censi's, and the covariance from the likelihood's shape of Olson's correlative matching.
///
/// spread: covariance of the guess (x, y, yaw) about the centre. Deterministic. Never throws.
std::optional<SubmapAlignment> align(const SubmapSurface& one, const NearestWall& other,
                                     const PlanarMove& guess, const Eigen::Matrix3d& spread,
                                     const Eigen::Vector2d& centre);

}  // namespace prospect
