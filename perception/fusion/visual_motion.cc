// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/visual_motion.h"

#include <cmath>

#include "perception/odometry/body_pose.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

}  // namespace

void set_motion(VisualMotion& visual, const Isometry3d& T_WC_reference, const Isometry3d& T_WC,
                const Matrix6d& covariance, const Isometry3d& T_BC) {
  const Isometry3d M = T_BC * T_WC_reference.inverse() * T_WC * T_BC.inverse();
  const Matrix3d R = M.linear();
  visual.motion << M.translation().head<2>(), std::atan2(R(1, 0), R(0, 0));
  // As that of a body whose W is B at the reference.
  const Eigen::Matrix4d C = body_covariance(M * T_BC, T_BC, covariance);
  visual.covariance << C.topLeftCorner<2, 2>(), C.topRightCorner<2, 1>(),
      C.bottomLeftCorner<1, 2>(), C(3, 3);
}

VisualMotion VisualMotionReader::read(const OdometryFrame& frame) {
  VisualMotion visual;
  visual.stamp = frame.stamp;
  // Of a frozen image nothing is tracked, and the pose is the one before.
  visual.state = frame.tracked > 0 ? frame.state : Localization::kLost;
  visual.scale_sigma = frame.camera_time_offset_depth;
  if (visual.state == Localization::kLost) return visual;
  visual.begins_map = frame.restarted || !has_reference_;
  if (visual.begins_map) {
    has_reference_ = true;
    T_WC_reference_ = frame.T_WC;
    return visual;
  }
  set_motion(visual, T_WC_reference_, frame.T_WC, frame.covariance_since_keyframe, T_BC_);
  visual.becomes_reference = frame.keyframe;
  if (frame.keyframe) T_WC_reference_ = frame.T_WC;
  return visual;
}

Isometry3d VisualMotionReader::camera_motion(const Pose& before, const Pose& now) const {
  const auto T_WB = [](const Pose& pose) {
    return Eigen::Translation3d(pose.position) *
           Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ());
  };
  return T_BC_.inverse() * T_WB(before).inverse() * T_WB(now) * T_BC_;
}

}  // namespace prospect
