#pragma once

#include <memory>

#include "engine/cost_to_go.h"
#include "engine/term.h"

namespace prospect {

/// Looking where the cost-to-go falls:
///
///   T = mean_{k=1..N} (s_k - h_k . g_k) / ..., with g = -v_max grad V(p_k), h = (cos yaw_k, sin
///   yaw_k): T = mean_k a(|g|) (1 - h . g / |g|),   a(|g|) = |g| / sqrt(|g|^2 + e^2),
///
/// that is 1 - cos(yaw_k - arg(-grad V)) wherever V really falls, faded out where grad V vanishes
/// (e = 0.2; |g| is 1 in open space), where a heading has no meaning. Computed as
///   (sqrt(|g|^2 + d^2) - d... see the source for the smooth form at g = 0.
///
/// At all stages, never at the last alone (that only defers the turn), and with its full gradient:
/// the derivative with respect to the position needs the Hessian of V. Smoothness: C1 (V is C2).
/// Thread-safety: const. A candidate with a non-finite pose gets NaN. Source: formulation, section
/// 6; the fading is our choice.
class HeadingAlignment final : public Term {
 public:
  /// Throws std::invalid_argument if v is null.
  explicit HeadingAlignment(std::shared_ptr<const CostToGo> v);

  std::string_view name() const override { return "heading_alignment"; }
  TermTraits traits() const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  std::shared_ptr<const CostToGo> v_;
};

}  // namespace prospect
