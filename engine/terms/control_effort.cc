// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/control_effort.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/terms/input_scale.h"

namespace prospect {

ControlEffort::ControlEffort(const Eigen::VectorXd& desired, const InputLimits& limits)
    : desired_(desired), R_(input_scale(limits)) {
  if (desired_.size() != R_.size()) {
    throw std::invalid_argument("control effort: desired input has " +
                                std::to_string(desired_.size()) + " entries; expected " +
                                std::to_string(R_.size()));
  }
  if (!desired_.allFinite()) {
    throw std::invalid_argument("control effort: desired input is not finite; expected numbers");
  }
}

TermTraits ControlEffort::traits() const {
  return {TermKind::kCost, Smoothness::kSmooth, true, "-",
          "mean over stages, inputs relative to their bounds"};
}

std::optional<ResidualForm> ControlEffort::residual_form(const Horizon& horizon, int sign) const {
  if (sign < 0) return std::nullopt;
  ResidualForm form;
  form.rows = horizon.N * static_cast<int>(R_.size());
  for (int row = 0; row < form.rows; ++row) {
    form.pattern.push_back({row, row / static_cast<int>(R_.size()), true});
  }
  return form;
}

void ControlEffort::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                             TermOutput& out) const {
  const int N = t.horizon.N, nu = static_cast<int>(R_.size());
  const double mean = 1.0 / N;
  out.value.row(0).setZero();
  for (int k = 0; k < N; ++k) {
    for (int j = 0; j < nu; ++j) {
      const int row = k * nu + j;
      out.value.row(0) += (mean * R_[j]) * (t.inputs.row(row) - desired_[j]).square();
      if (request.gradient) {
        out.input_gradient.row(row) += (2.0 * mean * R_[j]) * (t.inputs.row(row) - desired_[j]);
      }
      if (request.residuals != 0) {
        const double root = std::sqrt(2.0 * mean * R_[j]);
        out.residuals[row] = root * (t.inputs(row, 0) - desired_[j]);
        out.jacobian.col(row).setZero();
        out.jacobian(j, row) = root;
      }
    }
  }
}

}  // namespace prospect
