// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/ros/goal_pose.h"

#include <cmath>

#include "adapters/formats/files/input_error.h"

namespace prospect::ros {

Eigen::Isometry3d goal_transform(const Pose& pose, const std::string& name) {
  const auto& [x, y, z, w] = pose.orientation;
  const Eigen::Quaterniond rotation(w, x, y, z);
  const Eigen::Vector3d at(pose.position.x, pose.position.y, pose.position.z);
  if (!at.allFinite() || !(std::abs(rotation.norm() - 1.0) < 0.01)) {
    throw InputError(name + ": no pose; expected finite numbers and a unit quaternion");
  }
  Eigen::Isometry3d T(rotation.normalized());
  T.translation() = at;
  return T;
}

FloorGoal floor_goal(const Eigen::Isometry3d& T, const std::string& name) {
  const Eigen::Vector3d ahead = T.linear().col(0);
  if (ahead.head<2>().norm() < 0.1) {
    throw InputError(name + ": a goal that looks up or down; expected a heading on the floor");
  }
  check_upright(T, name);
  return {T.translation().head<2>(), std::atan2(ahead.y(), ahead.x())};
}

void check_upright(const Eigen::Isometry3d& T, const std::string& name) {
  constexpr double kLeast = 0.5;  // cosine
  if (T.linear()(2, 2) >= kLeast) return;
  throw InputError(name +
                   ": a robot that lies on its side or its head; expected its z axis up (a "
                   "quaternion is x, y, z, w)");
}

}  // namespace prospect::ros
