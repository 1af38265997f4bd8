#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "adapters/bench/problem_set.h"
#include "adapters/bench/solved_rule.h"
#include "adapters/bench/solver_choice.h"

namespace prospect {

struct BenchOptions {
  std::vector<double> deadlines = {0.0};  ///< [s]; 0: none
  int repeats = 1;                        ///< of each solve
  int max_evaluations = 10000;            ///< of each solve, unless the back end is told otherwise
  int seed = 1;
  double relative_tolerance = 0.01;  ///< of SolvedRule
  /// After each solve: how many are done, of how many.
  std::function<void(int done, int all)> on_solve;
  std::function<bool()> cancelled;  ///< asked before every solve and within it
};

/// One cell of the table: a problem, a back end, a deadline. Of the repeats of a solve the row is
///  * without a deadline the fastest: all give the same bits, and other work on the machine only
///    ever adds time;
///  * with a deadline the one of median result (feasible before infeasible, then by cost or
///    violation; of two middle ones the worse), with all its numbers.
struct BenchRow {
  int set = 0, problem = 0, solver = 0;  ///< indices
  double deadline = 0.0;                 ///< [s]; 0: none
  bool supported = true;                 ///< false: the back end cannot solve this problem
  StopReason stop = StopReason::kError;
  Quality quality = Quality::kNone;
  double cost = Problem::kRejectedCost;
  double violation = Problem::kRejectedCost;
  Counters counters;
  double seconds = 0.0;  ///< of the call of solve(), as its caller sees it
  /// The longest time past the deadline of all repeats. [s]
  double overrun = 0.0;
  std::vector<Improvement> trace;  ///< of a back end that keeps none: the result alone
  std::string detail;

  // Against the best known.
  bool solved = false;
  double gap = std::numeric_limits<double>::infinity();  ///< SolvedRule::gap; infinite: infeasible
  /// To the first point that counts as solved; infinite if there is none. [s], [-]
  double seconds_to_target = std::numeric_limits<double>::infinity();
  double evaluations_to_target = std::numeric_limits<double>::infinity();
};

/// What is known of a problem after the run.
struct BestKnown {
  double cost = std::numeric_limits<double>::infinity();  ///< infinite: no feasible point
  std::string found_by;  ///< "stored", or the label of the back end that beat it
};

struct BenchTable {
  std::vector<ProblemSet> sets;
  std::vector<std::string> solvers;  ///< labels
  BenchOptions options;
  std::vector<std::vector<BestKnown>> best;  ///< by set, problem
  std::vector<BenchRow> rows;                ///< by set, problem, deadline, solver
  /// Then sets and rows hold only the problems that every back end was done with.
  bool cancelled = false;

  SolvedRule rule(int set) const {
    return {options.relative_tolerance, sets[static_cast<std::size_t>(set)].absolute_tolerance};
  }
};

/// Solves every problem by every back end under every deadline, one after the other in one thread;
/// the back ends take turns on each problem, so that what slows the machine down for a while slows
/// all of them. The best known cost of a problem is the best of what the set states and of every
/// feasible result here. An error of a back end (StopReason::kError) is a row that solves nothing.
BenchTable run_bench(std::vector<ProblemSet> sets, const std::vector<SolverChoice>& solvers,
                     const BenchOptions& options);

/// Fills best and what rows hold against it.
void judge(BenchTable& table);

}  // namespace prospect
