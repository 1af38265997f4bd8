// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/trusted_pose.h"

#include <algorithm>

#include "perception/odometry/se3.h"

namespace prospect {

void TrustedPose::take(const Eigen::Isometry3d& pose, double now, const PyramidLevel& image) {
  const double dt = now - stamp;
  velocity.reset();
  if (dt <= 1.0) velocity = log_se3(pose * T_CW.inverse()) / std::max(dt, 1e-3);
  T_CW = pose;
  stamp = now;
  coarse = image;
}

Eigen::Isometry3d TrustedPose::continued(double now, double longest) const {
  return exp_se3(*velocity * std::min(now - stamp, longest)) * T_CW;
}

}  // namespace prospect
