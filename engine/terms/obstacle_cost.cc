// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/obstacle_cost.h"

#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

namespace prospect {

ObstacleCost::ObstacleCost(std::shared_ptr<const BodyClearance> clearance, double d_safe,
                           double d_des)
    : clearance_(std::move(clearance)) {
  if (clearance_ == nullptr) throw std::invalid_argument("obstacle cost: no clearance");
  if (!(d_safe >= 0.0) || !(d_des > d_safe) || !std::isfinite(d_des)) {
    throw std::invalid_argument("obstacle cost: d_safe = " + std::to_string(d_safe) +
                                " m, d_des = " + std::to_string(d_des) +
                                " m; expected 0 <= d_safe < d_des");
  }
  if (!(clearance_->saturation() >= d_des)) {
    throw std::invalid_argument(
        "obstacle cost: the clearance saturates at " + std::to_string(clearance_->saturation()) +
        " m; expected at least d_des = " + std::to_string(d_des) + " m (raise the field's cutoff)");
  }
  alpha_ = 6.0 / (d_des - d_safe);
  beta_ = 0.5 * (d_des + d_safe);
}

TermTraits ObstacleCost::traits() const {
  return {TermKind::kCost, Smoothness::kC1, true, "-", "mean over nodes and mid-points"};
}

std::optional<ResidualForm> ObstacleCost::residual_form(const Horizon& horizon, int sign) const {
  if (sign < 0) return std::nullopt;
  ResidualForm form;
  form.rows = 2 * horizon.N;
  for (int k = 0; k < horizon.N; ++k) {
    form.pattern.push_back({2 * k, k, false});
    form.pattern.push_back({2 * k, k + 1, false});
    form.pattern.push_back({2 * k + 1, k + 1, false});
  }
  return form;
}

void ObstacleCost::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                            TermOutput& out) const {
  const int N = t.horizon.N;
  const double share = 0.5 / N;
  const bool residuals = request.residuals != 0;
  const bool slopes = request.gradient || residuals;
  Eigen::Vector4d g;
  // Writes sqrt(2 share phi(d)) into a row, and its derivative, g times a factor, into blocks.
  const auto write = [&](double d, int row, std::initializer_list<int> blocks) {
    const double root = 1.0 / std::sqrt(1.0 + std::exp(2.0 * alpha_ * (d - beta_)));
    out.residuals[row] = std::sqrt(2.0 * share) * root;
    const double slope = -alpha_ * out.residuals[row] * (1.0 - root * root);
    const Eigen::Vector4d by_pose = slope / static_cast<double>(blocks.size()) * g;
    for (const int block : blocks) {
      out.set_pose_block(t, block, by_pose[0], by_pose[1], by_pose[2], by_pose[3]);
    }
  };
  for (int b = 0; b < t.batch(); ++b) {
    double sum = 0.0;
    double d = 0.0;
    // Adds phi at a pose; returns the factor of the clearance's gradient.
    const auto add = [&](const Pose& pose) {
      d = clearance_->clearance(pose, slopes ? &g : nullptr);
      const double tanh = std::tanh(alpha_ * (d - beta_));
      sum += 0.5 * (1.0 - tanh);
      return -0.5 * alpha_ * (1.0 - tanh * tanh) * share;
    };
    Pose here = t.pose(0, b);
    for (int k = 0; k < N; ++k) {
      const Pose next = t.pose(k + 1, b);
      const Pose middle{0.5 * (here.position + next.position), 0.5 * (here.yaw + next.yaw)};
      double slope = add(middle);
      if (request.gradient) {
        const Eigen::Vector4d half = 0.5 * slope * g;
        out.add_pose_gradient(t, k, b, half[0], half[1], half[2], half[3]);
        out.add_pose_gradient(t, k + 1, b, half[0], half[1], half[2], half[3]);
      }
      if (residuals) write(d, 2 * k, {3 * k, 3 * k + 1});
      slope = add(next);
      if (residuals) write(d, 2 * k + 1, {3 * k + 2});
      if (request.gradient) {
        out.add_pose_gradient(t, k + 1, b, slope * g[0], slope * g[1], slope * g[2], slope * g[3]);
      }
      here = next;
    }
    out.value(0, b) = sum * share;
  }
}

}  // namespace prospect
