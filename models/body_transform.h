// SPDX-License-Identifier: Apache-2.0
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

/// Whether T is a rotation, to 1e-3, and a translation, both finite.
inline bool is_pose(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return T.matrix().allFinite() &&
         (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3 && R.determinant() > 0.0;
}

}  // namespace prospect
