// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/cost_to_go_term.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace prospect {

CostToGoTerm::CostToGoTerm(std::shared_ptr<const CostToGo> v) : v_(std::move(v)) {
  if (!v_) throw std::invalid_argument("cost_to_go: no cost-to-go given; expected one");
}

TermTraits CostToGoTerm::traits() const {
  return {TermKind::kCost, Smoothness::kSmooth, true, "-",
          "terminal value and mean over stages [s], over the duration N dt"};
}

std::optional<ResidualForm> CostToGoTerm::residual_form(const Horizon& horizon, int sign) const {
  if (sign < 0) return std::nullopt;
  ResidualForm form;
  form.offset = v_->lowest() / (horizon.N * horizon.dt);
  form.rows = horizon.N;
  for (int k = 1; k <= horizon.N; ++k) form.pattern.push_back({k - 1, k, false});
  return form;
}

void CostToGoTerm::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                            TermOutput& out) const {
  const int N = t.horizon.N;
  const double scale = 0.5 / (N * t.horizon.dt);
  out.value.row(0).setZero();
  for (int k = 1; k <= N; ++k) {
    const double weight = scale * (1.0 / N + (k == N ? 1.0 : 0.0));
    if (request.residuals != 0) {
      Eigen::Vector2d g;
      const double V = v_->value({t.px(k, 0), t.py(k, 0)}, g);
      out.value(0, 0) += weight * V;
      // The weights of the spline sum to 1 but for rounding.
      const RootResidual root(weight * std::max(0.0, V - v_->lowest()));
      out.residuals[k - 1] = root.value;
      const Eigen::Vector2d by_position = root.slope * weight * g;
      out.set_pose_block(t, k - 1, by_position.x(), by_position.y(), 0.0, 0.0);
    } else if (request.gradient) {
      for (int b = 0; b < t.batch(); ++b) {
        Eigen::Vector2d g;
        out.value(0, b) += weight * v_->value({t.px(k, b), t.py(k, b)}, g);
        out.add_pose_gradient(t, k, b, weight * g.x(), weight * g.y(), 0.0, 0.0);
      }
    } else {
      for (int b = 0; b < t.batch(); ++b) {
        out.value(0, b) += weight * v_->value(t.px(k, b), t.py(k, b));
      }
    }
  }
}

}  // namespace prospect
