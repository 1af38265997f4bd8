// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/se3.h"

#include <cmath>

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

}  // namespace

Isometry3d exp_se3(const Vector6d& xi) {
  const Vector3d w = xi.tail<3>();
  const double angle = w.norm();
  const Matrix3d K = skew(w);
  double a, b;  // (1 - cos)/angle^2, (angle - sin)/angle^3
  Isometry3d T = Isometry3d::Identity();
  if (angle < 1e-5) {
    a = 0.5 - angle * angle / 24.0;
    b = 1.0 / 6.0 - angle * angle / 120.0;
  } else {
    a = (1.0 - std::cos(angle)) / (angle * angle);
    b = (angle - std::sin(angle)) / (angle * angle * angle);
  }
  const double s = angle < 1e-5 ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle;
  T.linear() = Matrix3d::Identity() + s * K + a * K * K;
  T.translation() = (Matrix3d::Identity() + a * K + b * K * K) * xi.head<3>();
  return T;
}

Vector6d log_se3(const Isometry3d& T) {
  const Eigen::AngleAxisd rotation(T.linear());
  const Vector3d w = rotation.angle() * rotation.axis();
  const double angle = rotation.angle();
  const Matrix3d K = skew(w);
  // V^-1 = I - K/2 + c K^2
  const double c = angle < 1e-4 ? 1.0 / 12.0 + angle * angle / 720.0
                                : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / (angle * angle);
  Vector6d xi;
  xi << (Matrix3d::Identity() - 0.5 * K + c * K * K) * T.translation(), w;
  return xi;
}

Matrix6d adjoint(const Isometry3d& T) {
  Matrix6d A = Matrix6d::Zero();
  const Matrix3d R = T.linear();
  A.topLeftCorner<3, 3>() = R;
  A.bottomRightCorner<3, 3>() = R;
  A.topRightCorner<3, 3>() = skew(T.translation()) * R;
  return A;
}

}  // namespace prospect
