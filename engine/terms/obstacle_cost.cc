#include "engine/terms/obstacle_cost.h"

#include <cmath>
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

void ObstacleCost::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                            TermOutput& out) const {
  const int N = t.horizon.N;
  const double share = 0.5 / N;
  Eigen::Vector4d g;
  for (int b = 0; b < t.batch(); ++b) {
    double sum = 0.0;
    // Adds phi at a pose; returns the factor of the clearance's gradient.
    const auto add = [&](const Pose& pose) {
      const double d = clearance_->clearance(pose, request.gradient ? &g : nullptr);
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
      slope = add(next);
      if (request.gradient) {
        out.add_pose_gradient(t, k + 1, b, slope * g[0], slope * g[1], slope * g[2], slope * g[3]);
      }
      here = next;
    }
    out.value(0, b) = sum * share;
  }
}

}  // namespace prospect
