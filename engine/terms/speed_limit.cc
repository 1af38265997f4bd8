// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/speed_limit.h"

namespace prospect {

struct SpeedLimit::Scratch : TermScratch {
  Scratch(int nx, int rows) : x(nx), c(rows), d_x(rows, nx) {}
  Eigen::VectorXd x, c;
  Eigen::MatrixXd d_x;
};

TermTraits SpeedLimit::traits() const {
  return {TermKind::kConstraint, Smoothness::kSmooth, true, "m/s, rad/s", "none"};
}

std::vector<JacobianBlock> SpeedLimit::jacobian_pattern(const Horizon& horizon) const {
  std::vector<JacobianBlock> pattern;
  for (int row = 0; row < rows(horizon); ++row) pattern.push_back({row, row / rows_ + 1, false});
  return pattern;
}

std::unique_ptr<TermScratch> SpeedLimit::make_scratch(const Horizon& horizon, int) const {
  return std::make_unique<Scratch>(horizon.nx(), rows_);
}

void SpeedLimit::evaluate(const TrajectoryBatch& t, const TermRequest& request,
                          TermScratch* scratch, TermOutput& out) const {
  if (rows_ == 0) return;
  auto& s = static_cast<Scratch&>(*scratch);
  const int nx = t.horizon.nx();
  for (int b = 0; b < t.batch(); ++b) {
    for (int k = 1; k <= t.horizon.N; ++k) {
      for (int i = 0; i < nx; ++i) s.x[i] = t.x(k, i, b);
      t.horizon.model->state_constraints(s.x, s.c, request.gradient ? &s.d_x : nullptr);
      for (int i = 0; i < rows_; ++i) {
        const int row = (k - 1) * rows_ + i;
        out.value(row, b) = s.c[i];
        if (request.gradient) out.jacobian.col(row).head(nx) = s.d_x.row(i).transpose();
      }
    }
  }
}

}  // namespace prospect
