// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "engine/frontiers/cost_to_go.h"
#include "engine/problem/term.h"

namespace prospect {

/// Looking where the cost-to-go falls, 1 - cos(yaw_k - arg(-grad V(p_k))) wherever it falls at all:
///
///   T = mean_{k=1..N} |g_k|^2 / (|g_k|^2 + e^2) (1 - cos(yaw_k - arg g_k))
///     = mean_{k=1..N} (|g_k|^2 - |g_k| (h_k . g_k)) / (|g_k|^2 + e^2),
///   g_k = -v_max grad V(p_k)  [-], 1 in open space,   h_k = (cos yaw_k, sin yaw_k),   e = 0.2.
///
/// The factor fades the term out where grad V vanishes and a heading has no meaning (at a
/// viewpoint, where nothing is reachable); the second form has no angle to wrap and a continuous
/// gradient at g = 0.
///
/// Residuals: (g_k - |g_k| h_k) / sqrt(N (|g_k|^2 + e^2)), in rows 2k-2 and 2k-1.
///
/// At all stages that the inputs move, never at the last alone: that only defers the turn. The
/// gradient is full: with respect to the position it needs the Hessian of V. Smoothness: C1 (V is
/// C2). Thread-safety: const. A candidate with a non-finite pose gets NaN. Source: formulation,
/// section 6; the fading is our choice.
class HeadingAlignment final : public Term {
 public:
  /// Throws std::invalid_argument if v is null.
  explicit HeadingAlignment(std::shared_ptr<const CostToGo> v);

  std::string_view name() const override { return "heading_alignment"; }
  TermTraits traits() const override;
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  std::shared_ptr<const CostToGo> v_;
};

}  // namespace prospect
