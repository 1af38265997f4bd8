// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace prospect {

/// A pose b measured in a pose a:
///   T_a^-1 T_b = T exp(n),   n = (t, omega) ~ N(0, information^-1) in b, [m] and [rad].
struct RelativePose {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Identity();
};

/// Whether it is finite and symmetric, each standard deviation that it claims lies between 1e-6 and
/// 1e6 (m or rad), and it is positive definite: of its matrix of correlations no eigenvalue is
/// below 1e-9.
bool is_information(const Eigen::Matrix<double, 6, 6>& information);

/// The same measurement from the other end, a in b:
///   (T exp(n))^-1 = T^-1 exp(-Ad(T) n),   information' = Ad(T^-1)^T information Ad(T^-1).
RelativePose inverse(const RelativePose& measured);

/// By how much two poses miss a measurement T: of E = T^-1 T_a^-1 T_b = (R, p), R with the
/// quaternion (w, v), w >= 0,
///   e = (p, 2 v),
/// which is n to first order. Its derivatives, where asked for, by T_a exp(xi) and T_b exp(xi):
///   by_b = [ R  0           ]        by_a = -by_b Ad(T_b^-1 T_a).
///          [ 0  w I + [v]_x ],
/// At a rotation of half a turn (w = 0) e says no longer where to turn.
Eigen::Matrix<double, 6, 1> measurement_error(const Eigen::Isometry3d& T_a,
                                              const Eigen::Isometry3d& T_b,
                                              const Eigen::Isometry3d& T,
                                              Eigen::Matrix<double, 6, 6>* by_a = nullptr,
                                              Eigen::Matrix<double, 6, 6>* by_b = nullptr);

}  // namespace prospect
