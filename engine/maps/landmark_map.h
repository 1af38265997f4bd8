// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/maps/odometry_noise.h"

namespace prospect {

/// Landmarks that one can stand for.
inline constexpr double kMostMultiplicity = 1e6;

/// A point of the odometry's map, in W.
struct Landmark {
  std::uint64_t id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               ///< l_i [m]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity() * 1e-4;  ///< Sigma_i [m^2]
  Eigen::Vector3d creation_direction =
      Eigen::Vector3d::UnitX();  ///< unit, from the point to the camera that created it
  double creation_range = 2.0;   ///< [m]
  double survival = 0.9;         ///< tau_i: share of expected views in which it was tracked
  /// mu_i: how many landmarks it stands for; above 1 where others like it were left out.
  double multiplicity = 1.0;
  /// How many others share its image cell when it is seen from a depth Z, over Z^2 [1/m^2]; 0:
  /// none. landmarks_per_cell.h fills it in.
  double per_cell = 0.0;
};

/// Landmarks known to the planner, and what has been learned of texture in general and of the
/// odometry that tracks them.
struct LandmarkMap {
  std::vector<Landmark> landmarks;
  /// rho: pessimistic quantile of new features per newly seen surface [1/m^2].
  double feature_density = 5.0;
  /// Side of the image cells of which the tracker keeps one landmark each, over the focal length
  /// [-]; 0: there are none, or the landmarks' survival accounts for them.
  double image_cell = 0.0;
  /// How the odometry's motions err, as it measured it of late; none: the planner's parameters say.
  std::optional<OdometryNoise> odometry_noise{};
};

}  // namespace prospect
