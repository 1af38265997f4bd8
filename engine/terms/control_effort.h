// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/term.h"

namespace prospect {

/// Effort and desired speed in one:  (1/N) sum_{k<N} |u_k - u_des|^2_R   [-],
/// R as in input_scale(). Smooth; depends on the inputs alone.
/// Residuals: sqrt(2 R_j / N) (u_k,j - u_des,j), row k nu + j.
/// Thread-safety: immutable; needs no scratch.
/// Source: formulation, section 7.
class ControlEffort : public Term {
 public:
  /// `desired` has one entry per input, in its unit. Throws std::invalid_argument for a wrong size
  /// or a non-finite entry.
  ControlEffort(const Eigen::VectorXd& desired, const InputLimits& limits);

  std::string_view name() const override { return "control_effort"; }
  TermTraits traits() const override;
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  Eigen::VectorXd desired_;
  Eigen::VectorXd R_;
};

}  // namespace prospect
