// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "models/types.h"

namespace prospect {

/// A move in the plane: p_new = R(yaw) p + (x, y) [m], [rad]; heights stay.
struct PlanarMove {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double yaw = 0.0;

  Eigen::Vector2d operator()(const Eigen::Vector2d& p) const {
    return Eigen::Rotation2Dd(yaw) * p + shift;
  }
  Eigen::Vector3d operator()(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d flat = (*this)(Eigen::Vector2d(p.head<2>()));
    return {flat.x(), flat.y(), p.z()};
  }
  Pose operator()(const Pose& p) const { return {(*this)(p.position), p.yaw + yaw}; }
  PlanarMove inverse() const { return {Eigen::Rotation2Dd(-yaw) * Eigen::Vector2d(-shift), -yaw}; }
  /// First the other one.
  PlanarMove operator*(const PlanarMove& first) const {
    return {(*this)(first.shift), yaw + first.yaw};
  }
  bool is_none() const { return shift.x() == 0.0 && shift.y() == 0.0 && yaw == 0.0; }
  /// How far places within `radius` [m] of p go, at most [m].
  double farthest(const Eigen::Vector2d& p, double radius) const {
    return ((*this)(p)-p).norm() + 2.0 * radius * std::abs(std::sin(0.5 * yaw));
  }
};

/// The move that takes `before` to `after`.
inline PlanarMove move_between(const Pose& before, const Pose& after) {
  const double yaw = std::remainder(after.yaw - before.yaw, 2.0 * M_PI);
  return {after.position.head<2>() - Eigen::Rotation2Dd(yaw) * before.position.head<2>(), yaw};
}

/// What T does in the plane.
inline PlanarMove planar_move(const Eigen::Isometry3d& T) {
  return {T.translation().head<2>(), std::atan2(T.linear()(1, 0), T.linear()(0, 0))};
}

}  // namespace prospect
