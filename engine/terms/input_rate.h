// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/term.h"

namespace prospect {

/// Smoothness of the inputs:  (1/N) sum_{k<N} |u_k - u_{k-1}|^2_R   [-],
/// u_{-1} the input in force (TrajectoryBatch::u_previous), R as in input_scale(). Within a knot
/// the difference is zero. Smooth; depends on the inputs alone.
/// Residuals: sqrt(2 R_j / N) (u_k,j - u_{k-1,j}), row k nu + j.
/// Thread-safety: immutable; needs no scratch. Source: formulation, section 7.
class InputRate : public Term {
 public:
  explicit InputRate(const InputLimits& limits);

  std::string_view name() const override { return "input_rate"; }
  TermTraits traits() const override;
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  Eigen::VectorXd R_;
};

}  // namespace prospect
