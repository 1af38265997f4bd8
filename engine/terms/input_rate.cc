#include "engine/terms/input_rate.h"

#include "engine/terms/input_scale.h"

namespace prospect {

InputRate::InputRate(const InputLimits& limits) : R_(input_scale(limits)) {}

TermTraits InputRate::traits() const {
  return {TermKind::kCost, Smoothness::kSmooth, true, "-",
          "mean over stages, inputs relative to their bounds"};
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
}

}  // namespace prospect
