// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/input_rate.h"

#include <cmath>

#include "engine/terms/input_scale.h"

namespace prospect {

InputRate::InputRate(const InputLimits& limits) : R_(input_scale(limits)) {}

TermTraits InputRate::traits() const {
  return {TermKind::kCost, Smoothness::kSmooth, true, "-",
          "mean over stages, inputs relative to their bounds"};
}

std::optional<ResidualForm> InputRate::residual_form(const Horizon& horizon, int sign) const {
  if (sign < 0) return std::nullopt;
  const int nu = static_cast<int>(R_.size());
  ResidualForm form;
  form.rows = horizon.N * nu;
  for (int row = 0; row < form.rows; ++row) {
    form.pattern.push_back({row, row / nu, true});
    if (row >= nu) form.pattern.push_back({row, row / nu - 1, true});
  }
  return form;
}

void InputRate::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                         TermOutput& out) const {
  const int N = t.horizon.N, nu = static_cast<int>(R_.size());
  const double mean = 1.0 / N;
  out.value.row(0).setZero();
  for (int j = 0; j < nu; ++j) {
    out.value.row(0) += (mean * R_[j]) * (t.inputs.row(j) - t.u_previous[j]).square();
    if (request.gradient) {
      out.input_gradient.row(j) += (2.0 * mean * R_[j]) * (t.inputs.row(j) - t.u_previous[j]);
    }
  }
  for (int row = nu; row < N * nu; ++row) {
    const double w = mean * R_[row % nu];
    out.value.row(0) += w * (t.inputs.row(row) - t.inputs.row(row - nu)).square();
    if (request.gradient) {
      const auto slope = 2.0 * w * (t.inputs.row(row) - t.inputs.row(row - nu));
      out.input_gradient.row(row) += slope;
      out.input_gradient.row(row - nu) -= slope;
    }
  }
  if (request.residuals == 0) return;
  Eigen::Index block = 0;
  for (int row = 0; row < N * nu; ++row) {
    const int j = row % nu;
    const double root = std::sqrt(2.0 * mean * R_[j]);
    const double before = row < nu ? t.u_previous[j] : t.inputs(row - nu, 0);
    out.residuals[row] = root * (t.inputs(row, 0) - before);
    for (const double slope : {root, -root}) {
      if (slope < 0.0 && row < nu) break;
      out.jacobian.col(block).setZero();
      out.jacobian(j, block++) = slope;
    }
  }
}

}  // namespace prospect
