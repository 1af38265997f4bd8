// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "engine/problem/term.h"

namespace prospect {

/// Rate limits of the inputs as constraint rows, >= 0 where they hold:
///
///   rate_j dt - (u_k,j - u_{k-1},j) >= 0,    rate_j dt + (u_k,j - u_{k-1},j) >= 0
///
/// in the input's unit, for every input j with a finite rate and every stage k where the input may
/// change: with M knots (stage k on knot floor(k M / N), as in Problem) these are k = 0 (against
/// the input in force, u_{-1}) and the first stage of every later knot. Within a knot the input is
/// constant and a row would always hold.
///
/// The change is commanded in one stage, so it is limited to rate * dt however many stages a knot
/// spans: a base that follows its rate limit has reached the new input by the end of that stage.
/// The price is that with knots of s stages the input can rise by rate * dt only once every s
/// stages.
///
/// Row order: by stage, then input, then sign (first row the upper limit). Linear, hence smooth.
/// Thread-safety: immutable; needs no scratch.
/// Source: formulation, section 1 (rate limits) and 7.
class RateLimit : public Term {
 public:
  /// `knots`: M of the problem; 0: an input that may change at every stage (M = N).
  explicit RateLimit(const InputLimits& limits, int knots = 0);

  std::string_view name() const override { return "rate_limit"; }
  TermTraits traits() const override;
  int rows(const Horizon& horizon) const override;
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& horizon) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  bool changes(int stage, int N) const;

  std::vector<std::pair<int, double>> limited_;  // input and its finite rate
  int knots_;
};

}  // namespace prospect
