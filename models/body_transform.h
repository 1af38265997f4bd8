#pragma once

#include <Eigen/Geometry>

#include "models/types.h"

namespace prospect {

/// T_WB, which maps body coordinates to W: turned by the yaw about W's z axis, at the position.
inline Eigen::Isometry3d body_transform(const Pose& pose) {
  Eigen::Isometry3d T_WB = Eigen::Isometry3d::Identity();
  T_WB.linear() = Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T_WB.translation() = pose.position;
  return T_WB;
}

}  // namespace prospect
