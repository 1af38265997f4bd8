// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>

#include "adapters/formats/ros/geometry_msgs.h"

namespace prospect::ros {

/// Where a pose sends a robot on the floor: its heading is that of the pose's x axis.
struct FloorGoal {
  Eigen::Vector2d place;  ///< [m]
  double yaw = 0.0;       ///< [rad]
};

/// Of a pose in its frame. `name` is who says so. Throws InputError, one line, for one that is not
/// finite or without a rotation.
Eigen::Isometry3d goal_transform(const Pose& pose, const std::string& name);
/// Throws InputError for one that looks up or down, or is not upright.
FloorGoal floor_goal(const Eigen::Isometry3d& T, const std::string& name);
/// Throws InputError, one line, for what no robot on a floor can have: a z axis that is more than
/// 60 degrees from its frame's, as of a quaternion whose w was written first.
void check_upright(const Eigen::Isometry3d& T, const std::string& name);

}  // namespace prospect::ros
