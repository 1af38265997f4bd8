// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/obstacle_cost.h"

#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

namespace prospect {

ObstacleCost::ObstacleCost(std::shared_ptr<const BodyClearance> clearance, double d_safe,
                           double d_des, std::vector<Mover> movers, double radius)
    : clearance_(std::move(clearance)), movers_(std::move(movers)), radius_(radius) {
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
  for (const Mover& mover : movers_) {
    if (!mover.sound()) {
      throw std::invalid_argument(
          "obstacle cost: a mover is not finite or below zero in size; expected finite numbers");
    }
  }
  if (!(radius_ >= 0.0) || !std::isfinite(radius_)) {
    throw std::invalid_argument("obstacle cost: radius = " + std::to_string(radius_) +
                                " m; expected >= 0");
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

double ObstacleCost::phi_among_movers(const Pose& pose, double time, Eigen::Vector4d* slope) const {
  // phi of several is that of one, and then of the next where the ones before are not near; so
  // nothing is lost where all are small.
  const auto near = [this](double d) { return 1.0 / (1.0 + std::exp(2.0 * alpha_ * (d - beta_))); };
  Eigen::Vector4d g;
  double phi = near(clearance_->clearance(pose, slope ? &g : nullptr));
  if (slope) *slope = -2.0 * alpha_ * phi * (1.0 - phi) * g;
  for (const Mover& mover : movers_) {
    const Eigen::Vector2d away = pose.position.head<2>() - mover.at(time);
    const double far = away.norm();
    const double one = near(far - mover.reach(time) - radius_);
    if (slope) {
      *slope *= 1.0 - one;
      if (far > 0.0) {
        slope->head<2>() -= (1.0 - phi) * 2.0 * alpha_ * one * (1.0 - one) / far * away;
      }
    }
    phi += (1.0 - phi) * one;
  }
  return phi;
}

void ObstacleCost::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                            TermOutput& out) const {
  const int N = t.horizon.N;
  const double share = 0.5 / N;
  const bool residuals = request.residuals != 0;
  const bool slopes = request.gradient || residuals;
  Eigen::Vector4d g;
  // Writes sqrt(2 share phi) into a row, and its derivative, that of sqrt(phi), into blocks.
  const auto write = [&](double root, double slope, int row, std::initializer_list<int> blocks) {
    out.residuals[row] = std::sqrt(2.0 * share) * root;
    const Eigen::Vector4d by_pose = slope / static_cast<double>(blocks.size()) * g;
    for (const int block : blocks) {
      out.set_pose_block(t, block, by_pose[0], by_pose[1], by_pose[2], by_pose[3]);
    }
  };
  for (int b = 0; b < t.batch(); ++b) {
    double sum = 0.0;
    double d = 0.0, phi = 0.0;
    // Adds phi at a pose and a time; returns the factor of g that makes it share times its slope.
    const auto add = [&](const Pose& pose, double time) {
      if (!movers_.empty()) {
        phi = phi_among_movers(pose, time, slopes ? &g : nullptr);
        sum += phi;
        return share;
      }
      d = clearance_->clearance(pose, slopes ? &g : nullptr);
      const double tanh = std::tanh(alpha_ * (d - beta_));
      sum += 0.5 * (1.0 - tanh);
      return -0.5 * alpha_ * (1.0 - tanh * tanh) * share;
    };
    const auto write_root = [&](int row, std::initializer_list<int> blocks) {
      if (!movers_.empty()) {
        write(std::sqrt(phi), std::sqrt(2.0 * share) * 0.5 / std::sqrt(phi), row, blocks);
        return;
      }
      const double root = 1.0 / std::sqrt(1.0 + std::exp(2.0 * alpha_ * (d - beta_)));
      write(root, -alpha_ * (std::sqrt(2.0 * share) * root) * (1.0 - root * root), row, blocks);
    };
    Pose here = t.pose(0, b);
    for (int k = 0; k < N; ++k) {
      const Pose next = t.pose(k + 1, b);
      const Pose middle{0.5 * (here.position + next.position), 0.5 * (here.yaw + next.yaw)};
      double slope = add(middle, (k + 0.5) * t.horizon.dt);
      if (request.gradient) {
        const Eigen::Vector4d half = 0.5 * slope * g;
        out.add_pose_gradient(t, k, b, half[0], half[1], half[2], half[3]);
        out.add_pose_gradient(t, k + 1, b, half[0], half[1], half[2], half[3]);
      }
      if (residuals) write_root(2 * k, {3 * k, 3 * k + 1});
      slope = add(next, (k + 1) * t.horizon.dt);
      if (residuals) write_root(2 * k + 1, {3 * k + 2});
      if (request.gradient) {
        out.add_pose_gradient(t, k + 1, b, slope * g[0], slope * g[1], slope * g[2], slope * g[3]);
      }
      here = next;
    }
    out.value(0, b) = sum * share;
  }
}

}  // namespace prospect
