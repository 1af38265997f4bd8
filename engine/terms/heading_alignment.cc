// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/heading_alignment.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace prospect {
namespace {
constexpr double kFade = 0.2;  // e
}  // namespace

HeadingAlignment::HeadingAlignment(std::shared_ptr<const CostToGo> v) : v_(std::move(v)) {
  if (!v_) throw std::invalid_argument("heading_alignment: no cost-to-go given; expected one");
}

TermTraits HeadingAlignment::traits() const {
  return {TermKind::kCost, Smoothness::kC1, true, "-", "mean over stages"};
}

std::optional<ResidualForm> HeadingAlignment::residual_form(const Horizon& horizon,
                                                            int sign) const {
  if (sign < 0) return std::nullopt;
  ResidualForm form;
  form.rows = 2 * horizon.N;
  for (int row = 0; row < form.rows; ++row) form.pattern.push_back({row, row / 2 + 1, false});
  return form;
}

void HeadingAlignment::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                                TermOutput& out) const {
  const int N = t.horizon.N;
  const double v_max = v_->v_max();
  out.value.row(0).setZero();
  for (int k = 1; k <= N; ++k) {
    for (int b = 0; b < t.batch(); ++b) {
      const Eigen::Vector2d p(t.px(k, b), t.py(k, b));
      const double yaw = t.yaw(k, b);
      const Eigen::Vector2d h(std::cos(yaw), std::sin(yaw));
      Eigen::Vector2d gradient;
      Eigen::Matrix2d hessian;
      if (request.gradient || request.residuals != 0) {
        v_->value(p, gradient, hessian);
      } else {
        v_->value(p, gradient);
      }
      const Eigen::Vector2d g = -v_max * gradient;
      const double norm = g.norm();
      const double along = h.dot(g);
      const double q = norm * norm + kFade * kFade;
      const double numerator = norm * norm - norm * along;
      out.value(0, b) += numerator / (q * N);
      if (request.residuals != 0) {
        const double scale = 1.0 / std::sqrt(q * N);
        const Eigen::Vector2d apart = g - norm * h;
        Eigen::Matrix2d by_g = Eigen::Matrix2d::Identity() - apart * g.transpose() / q;
        if (norm > 0.0) by_g -= h * g.transpose() / norm;
        const Eigen::Matrix2d by_position = -v_max * scale * by_g * hessian;
        const Eigen::Vector2d by_yaw = -norm * scale * Eigen::Vector2d(-h.y(), h.x());
        for (int i = 0; i < 2; ++i) {
          const int row = 2 * (k - 1) + i;
          out.residuals[row] = scale * apart[i];
          out.set_pose_block(t, row, by_position(i, 0), by_position(i, 1), 0.0, by_yaw[i]);
        }
      }
      if (!request.gradient) continue;
      Eigen::Vector2d d_g = (2.0 * g - norm * h) / q - g * (2.0 * numerator / (q * q));
      // (h . g) g / |g| vanishes with g.
      if (norm > 0.0) d_g -= g * (along / (norm * q));
      const Eigen::Vector2d d_p = -v_max * (hessian * d_g);
      const double d_yaw = -norm * (h.x() * g.y() - h.y() * g.x()) / q;
      out.add_pose_gradient(t, k, b, d_p.x() / N, d_p.y() / N, 0.0, d_yaw / N);
    }
  }
}

}  // namespace prospect
