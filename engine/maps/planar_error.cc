// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/planar_error.h"

#include <Eigen/Eigenvalues>

namespace prospect {

Eigen::Matrix3d carried(const Eigen::Matrix3d& P, const Eigen::Vector2d& way) {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = -way.y();
  F(1, 2) = way.x();
  return F * P * F.transpose();
}

Eigen::Matrix3d added(const Eigen::Matrix3d& before, const Eigen::Vector2d& way,
                      const Eigen::Matrix3d& after) {
  const Eigen::Matrix3d Q = after - carried(before, way);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(0.5 * (Q + Q.transpose()));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace prospect
