// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "adapters/formats/ros/geometry_msgs.h"
#include "models/types.h"

namespace prospect::ros {

/// A turn about z by yaw [rad].
inline Quaternion turned_by(double yaw) {
  return {0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)};
}

inline Pose pose_message(const prospect::Pose& pose) {
  return {{pose.position.x(), pose.position.y(), pose.position.z()}, turned_by(pose.yaw)};
}

}  // namespace prospect::ros
