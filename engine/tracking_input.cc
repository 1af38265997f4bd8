#include "engine/tracking_input.h"

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
  const Eigen::Vector4d at = velocity(u0);
  Eigen::MatrixXd J(4, nu);
  Eigen::VectorXd u = u0;
  for (int j = 0; j < nu; ++j) {
    constexpr double h = 1e-4;
    u[j] = u0[j] + h;
    const Eigen::Vector4d plus = velocity(u);
    u[j] = u0[j] - h;
    J.col(j) = (plus - velocity(u)) / (2.0 * h);
    u[j] = u0[j];
  }
  u = u0 + J.completeOrthogonalDecomposition().solve(stacked(desired) - at);
  for (int j = 0; j < nu; ++j) {
    if (!std::isfinite(u[j])) u[j] = u0[j];
    const double reach = limits.rate[j] * dt;
    if (std::isfinite(reach)) u[j] = std::clamp(u[j], previous[j] - reach, previous[j] + reach);
    u[j] = std::clamp(u[j], limits.lower[j], limits.upper[j]);
  }
  return u;
}

}  // namespace prospect
