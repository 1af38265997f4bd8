// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/relative_pose.h"

#include "engine/support/eigenvalues.h"
#include "perception/odometry/se3.h"

namespace prospect {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

bool is_information(const Matrix6d& information) {
  if (!information.allFinite()) return false;
  const Vector6d diagonal = information.diagonal();
  if (diagonal.minCoeff() < 1e-12 || diagonal.maxCoeff() > 1e12) return false;
  const Vector6d scale = diagonal.cwiseSqrt().cwiseInverse();
  const Matrix6d correlations = scale.asDiagonal() * information * scale.asDiagonal();
  if ((correlations - correlations.transpose()).cwiseAbs().maxCoeff() > 1e-6) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(correlations, Eigen::EigenvaluesOnly);
  return solver.info() == Eigen::Success && solver.eigenvalues()[0] > 1e-9;
}

RelativePose inverse(const RelativePose& measured) {
  RelativePose result;
  result.T = measured.T.inverse();
  const Matrix6d Ad = adjoint(result.T);
  result.information = Ad.transpose() * measured.information * Ad;
  return result;
}

Vector6d measurement_error(const Isometry3d& T_a, const Isometry3d& T_b, const Isometry3d& T,
                           Matrix6d* by_a, Matrix6d* by_b) {
  const Isometry3d E = T.inverse() * (T_a.inverse() * T_b);
  Eigen::Quaterniond q(E.linear());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const Vector3d v = q.vec();
  if (by_a != nullptr || by_b != nullptr) {
    Matrix6d B = Matrix6d::Zero();
    B.topLeftCorner<3, 3>() = E.linear();
    B.bottomRightCorner<3, 3>() = q.w() * Matrix3d::Identity() + skew(v);
    if (by_a != nullptr) *by_a = -B * adjoint(T_b.inverse() * T_a);
    if (by_b != nullptr) *by_b = B;
  }
  Vector6d e;
  e << E.translation(), 2.0 * v;
  return e;
}

}  // namespace prospect
