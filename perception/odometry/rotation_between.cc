// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/rotation_between.h"

#include <algorithm>
#include <cmath>

namespace prospect {

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  constexpr double kOpposite =
      1e-12;  // of the cosine: nearer to -1 the cross product has no direction
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double cosine = std::max(-1.0, a.dot(b));
  Eigen::Quaterniond q;
  if (cosine < kOpposite - 1.0) {
    const double w2 = 0.5 * (1.0 + cosine);
    q.w() = std::sqrt(w2);
    q.vec() = std::sqrt(1.0 - w2) * a.unitOrthogonal();
  } else {
    const double s = std::sqrt(2.0 * (1.0 + cosine));
    q.w() = 0.5 * s;
    q.vec() = a.cross(b) * (1.0 / s);
  }
  return q;
}

}  // namespace prospect
