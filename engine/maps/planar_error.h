// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace prospect {

// Errors of a pose in the plane, of (x, y, yaw) [m, m, rad], and what follows for places that are
// known relative to it. Pure functions.

/// Variance [m^2] along any one direction, on average, of a place that lies `lever` [m] from the
/// pose, if P is the covariance of the pose: with J a quarter turn,
///     (tr P_pp + 2 J lever . P_p,yaw + |lever|^2 P_yaw,yaw) / 2.
inline double place_variance(const Eigen::Matrix3d& P, const Eigen::Vector2d& lever) {
  const Eigen::Vector2d turned(-lever.y(), lever.x());
  return std::max(0.0, 0.5 * P.topLeftCorner<2, 2>().trace() +
                           turned.dot(P.topRightCorner<2, 1>()) +
                           0.5 * lever.squaredNorm() * P(2, 2));
}

/// Covariance of a pose that lies `way` [m] from the one that has P, known exactly relative to it.
Eigen::Matrix3d carried(const Eigen::Matrix3d& P, const Eigen::Vector2d& way);

/// What odometry has added on a `way` [m] from a pose of covariance `before` to one of `after`: the
/// positive semi-definite part of after - carried(before, way). Who has found a place again may
/// know it better than before.
Eigen::Matrix3d added(const Eigen::Matrix3d& before, const Eigen::Vector2d& way,
                      const Eigen::Matrix3d& after);

}  // namespace prospect
