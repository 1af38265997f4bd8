// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace prospect {

/// Structure-of-arrays storage of a batch: a row is one scalar quantity, a column is one candidate.
/// Row-major, so that one quantity of all candidates is contiguous and loops over the batch
/// vectorise.
using BatchArray = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Largest coordinate [m] that is taken: far beyond any map, and addresses of cells and voxels stay
/// within int.
inline constexpr double kFarthest = 1e6;

/// Pose with four degrees of freedom: position p in W [m] and yaw about W's z axis [rad].
/// Not wrapped: yaw is continuous along a trajectory.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double yaw = 0.0;
};

/// Velocity in the body frame B: linear [m/s] and yaw rate [rad/s]. What a base is commanded.
struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  double yaw_rate = 0.0;
};

}  // namespace prospect
