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

/// Aligns the walls of one submap with those of another one, in the plane:
///   min over (x, y, yaw)  sum_i rho((n_i . (q_i - p_i)) / sigma),
/// q_i the wall of the one at the place of now, p_i the nearest wall of the other one that faces
/// alike and n_i its normal, rho(e) = log(1 + e^2), over those within a reach that is drawn in from
/// 0.6 to 0.15 m; Gauss-Newton, 15 iterations. Walls that the other one does not know count for
/// nothing, so any part may overlap, seen from anywhere. Begun from several places: from `guess`,
/// and where that is less sure than 0.1 m, from those around it, by twice its deviation, 0.5 m and
/// 0.15 rad at most. The end of most likelihood counts,
///   log L = k sum_i max(0, rho(0.15 m / sigma) - rho_i),
/// k = 0.1: as if every tenth wall was independent, as walls of one scan share its error.
///
/// Covariance: that of the likelihood. Along each eigenvector of the Hessian it is walked, to
/// 0.6 m either way; v its variance there, the information is 1 / v less that of a likelihood that
/// does not fall at all. So nothing is measured along a corridor, nor where walls repeat
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
