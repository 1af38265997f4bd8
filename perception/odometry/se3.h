// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace prospect {

/// [a]_x, the matrix of the cross product: skew(a) b = a x b.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d S;
  S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return S;
}

/// exp: se(3) -> SE(3) for xi = (t, omega): rotation by omega, translation by V t,
///   V = I + (1 - cos|omega|) / |omega|^2 [omega]_x + (|omega| - sin|omega|) / |omega|^3
///   [omega]_x^2.
Eigen::Isometry3d exp_se3(const Eigen::Matrix<double, 6, 1>& xi);
/// Its inverse; rotations below pi.
Eigen::Matrix<double, 6, 1> log_se3(const Eigen::Isometry3d& T);

/// Adjoint of T = (R, p) for xi = (t, omega):  T exp(xi) T^-1 = exp(Ad xi),
///   Ad = [ R  [p]_x R ]
///        [ 0     R    ].
Eigen::Matrix<double, 6, 6> adjoint(const Eigen::Isometry3d& T);

}  // namespace prospect
