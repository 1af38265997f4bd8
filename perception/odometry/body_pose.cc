// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/body_pose.h"

#include <cmath>

#include "perception/odometry/se3.h"

namespace prospect {

using Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Pose body_pose(const Isometry3d& T_WB) {
  const Eigen::Matrix3d R = T_WB.linear();
  return {T_WB.translation(), std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Matrix4d body_covariance(const Isometry3d& T_WC, const Isometry3d& T_BC,
                                const Matrix6d& covariance) {
  const Eigen::Matrix3d R = (T_WC * T_BC.inverse()).linear();
  Eigen::Matrix<double, 4, 6> J = Eigen::Matrix<double, 4, 6>::Zero();
  J.topLeftCorner<3, 3>() = R;
  J.bottomRightCorner<1, 3>() = R.row(2);
  const Eigen::Matrix<double, 4, 6> D = J * adjoint(T_BC);
  const Eigen::Matrix4d C = D * covariance * D.transpose();
  return 0.5 * (C + C.transpose());
}

}  // namespace prospect
