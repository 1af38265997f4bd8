// SPDX-License-Identifier: Apache-2.0
#include "models/tracking_input.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace prospect {
namespace {

Eigen::Vector4d stacked(const Twist& t) {
  return {t.linear.x(), t.linear.y(), t.linear.z(), t.yaw_rate};
}

}  // namespace

Eigen::VectorXd tracking_input(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& x,
                               const Eigen::Ref<const Eigen::VectorXd>& previous,
                               const Twist& desired, double dt) {
  const int nu = model.nu();
  const InputLimits& limits = model.limits();
  const Eigen::VectorXd u0 = model.braking_input(x, previous, dt);
  Eigen::VectorXd next(model.nx());
  const auto velocity = [&](const Eigen::VectorXd& u) {
    model.step(x, u, dt, next);
    return stacked(model.twist(next, u));
  };
  const Eigen::Vector4d wanted = stacked(desired);
  Eigen::MatrixXd J(4, nu);
  Eigen::VectorXd u = u0, around(nu);
  for (int iteration = 0; iteration < 4; ++iteration) {
    const Eigen::Vector4d missing = wanted - velocity(u);
    if (iteration > 0 && missing.norm() < 1e-10) break;
    around = u;
    for (int j = 0; j < nu; ++j) {
      constexpr double h = 1e-4;
      around[j] = u[j] + h;
      const Eigen::Vector4d plus = velocity(around);
      around[j] = u[j] - h;
      J.col(j) = (plus - velocity(around)) / (2.0 * h);
      around[j] = u[j];
    }
    const Eigen::VectorXd change = J.completeOrthogonalDecomposition().solve(missing);
    u += change;
    // Where some velocity cannot be had at all, the first step is the answer.
    if (change.norm() < 1e-10 || !u.allFinite()) break;
  }
  for (int j = 0; j < nu; ++j) {
    if (!std::isfinite(u[j])) u[j] = u0[j];
    const double reach = limits.rate[j] * dt;
    if (std::isfinite(reach)) u[j] = std::clamp(u[j], previous[j] - reach, previous[j] + reach);
    u[j] = std::clamp(u[j], limits.lower[j], limits.upper[j]);
  }
  return u;
}

}  // namespace prospect
