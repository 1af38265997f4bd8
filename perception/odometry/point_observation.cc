// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/point_observation.h"

#include <Eigen/LU>

#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

}  // namespace

bool observation_residual(const StereoCamera& camera, const Isometry3d& T_CW,
                          const PointObservation& o, const Vector3d& m, ObservationResidual& out) {
  if (!(m.z() > 0.0)) return false;
  const Vector3d Y = T_CW * (o.T_WA * camera.triangulate(m.x(), m.y(), m.z()));
  if (!(Y.z() > 0.01)) return false;
  Eigen::Matrix3d P;
  P.topRows<2>() = camera.left.projection_jacobian(Y);
  out.r.head<2>() = o.left - camera.left.project(Y);
  if (o.sees_right()) {
    const Vector3d right = Y - Vector3d(camera.baseline, 0.0, 0.0);
    P.row(2) = camera.left.projection_jacobian(right).row(0);
    out.r[2] = o.right - camera.left.project(right).x();
  } else {
    P.row(2).setZero();
    out.r[2] = 0.0;
  }
  // exp(xi) Y = Y + t + omega x Y
  out.d_pose.leftCols<3>() = -P;
  out.d_pose.rightCols<3>() = P * skew(Y);
  out.d_measured =
      -P * T_CW.linear() * o.T_WA.linear() * camera.triangulation_jacobian(m.x(), m.y(), m.z());
  return true;
}

Matrix3d observation_weight(const PointObservation& o, const ObservationResidual& residual,
                            double sigma_left, double sigma_right) {
  Matrix3d S =
      residual.d_measured * o.sigma.cwiseAbs2().asDiagonal() * residual.d_measured.transpose();
  S.topLeftCorner<2, 2>() += o.left_covariance;
  S(0, 0) += sigma_left * sigma_left;
  S(1, 1) += sigma_left * sigma_left;
  Matrix3d W = Matrix3d::Zero();
  if (o.sees_right()) {
    S(2, 2) += sigma_right * sigma_right + o.right_variance;
    W = S.inverse();
  } else {
    W.topLeftCorner<2, 2>() = S.topLeftCorner<2, 2>().inverse();
  }
  return 0.5 * (W + W.transpose());
}

}  // namespace prospect
