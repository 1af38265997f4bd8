// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "adapters/missions/bench/bench_table.h"
#include "adapters/missions/bench/problem_set.h"
#include "adapters/missions/bench/solver_choice.h"

namespace prospect {

struct BenchOptions {
  std::vector<double> deadlines = {0.0};  ///< [s]; 0: none
  std::vector<int> seeds = {1};           ///< of the back ends; each solves anew
  int repeats = 1;                        ///< of each solve
  int max_evaluations = 10000;            ///< of each solve, unless the back end is told otherwise
  double relative_tolerance = 0.01;       ///< of SolvedRule
  SolveClock clock = SolveClock::kWall;   ///< of deadlines and of all times
  nlohmann::ordered_json environment = nlohmann::ordered_json::object();  ///< of this machine
  /// After each solve: how many are done, of how many.
  std::function<void(int done, int all)> on_solve;
  /// After each row of this run, with the table so far; not for those taken over.
  std::function<void(const BenchTable& table, const BenchRow& row)> on_row;
  std::function<bool()> cancelled;  ///< asked before every solve and within it
};

/// The table of such a bench before its first row. `environments` holds the one of the options.
BenchTable empty_bench(const std::vector<ProblemSet>& sets,
                       const std::vector<SolverChoice>& solvers, const BenchOptions& options);

/// Solves every problem by every back end under every deadline and seed, one after the other in one
/// thread; the back ends take turns on each problem, so that what slows the machine down for a
/// while slows all of them. An error of a back end (StopReason::kError) is a row that solves
/// nothing.
///
/// A claimed optimum is judged for all back ends alike (judge.h), after the clock has stopped. A
/// solution at a bound that nobody stated is none, and solves nothing: stated_bounds.h.
///
/// `table`: that of empty_bench(), with rows of an earlier run, which are not solved again.
BenchTable run_bench(const std::vector<ProblemSet>& sets, const std::vector<SolverChoice>& solvers,
                     const BenchOptions& options, BenchTable table);
BenchTable run_bench(const std::vector<ProblemSet>& sets, const std::vector<SolverChoice>& solvers,
                     const BenchOptions& options);

}  // namespace prospect
