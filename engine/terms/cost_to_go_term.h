// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "engine/frontiers/cost_to_go.h"
#include "engine/problem/term.h"

namespace prospect {

/// Cost of what lies past the horizon:
///
///   T = (1/2 V(p_N) + 1/2 mean_{k=1..N} V(p_k)) / (N dt),   [s / s = -]
///
/// V the cost-to-go in seconds at v_max. Half of it is the stage mean: with the terminal value
/// alone, moving later costs the same as moving now, and every new plan defers again. Stage 0 is
/// left out: it is given.
///
/// Residuals: the root of 2 w_k (V(p_k) - V_0), T = sum_k w_k V(p_k), V_0 = CostToGo::lowest(), in
/// row k-1.
///
/// Smoothness: C2 in p. Exact gradient. Thread-safety: const. A candidate with a non-finite
/// position gets NaN. Source: formulation, sections 6 and 7.
class CostToGoTerm final : public Term {
 public:
  /// Throws std::invalid_argument if v is null.
  explicit CostToGoTerm(std::shared_ptr<const CostToGo> v);

  std::string_view name() const override { return "cost_to_go"; }
  TermTraits traits() const override;
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  std::shared_ptr<const CostToGo> v_;
};

}  // namespace prospect
