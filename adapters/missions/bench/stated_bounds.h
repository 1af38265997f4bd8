// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "adapters/missions/bench/problem_set.h"

namespace prospect {

/// A solve, and the problem that it was of in the end.
struct StatedBoundsSolve {
  Result result;
  std::shared_ptr<const Problem> within;
  bool held = false;  ///< by a bound that nobody stated: result.x is no solution of the problem
};

/// Solves the problem. Where the solution is at a bound that nobody stated, the solve goes on from
/// there with such bounds farther out, up to 1e8 beyond the start, with the evaluations that are
/// left. A result that is still held is never an optimum; if the cost fell to the end, the problem
/// is unbounded (StopReason::kUnbounded), and so is one whose cost came below -1e100, wherever that
/// is.
StatedBoundsSolve solve_within_stated_bounds(const BenchProblem& problem, const Solver& solver,
                                             const Options& options, const StopCondition& stop);

}  // namespace prospect
