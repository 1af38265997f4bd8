#pragma once

#include <string>
#include <vector>

#include "adapters/bench/bench_run.h"
#include "adapters/bench/gap_curves.h"
#include "adapters/bench/performance_profile.h"

namespace prospect {

/// What one back end did with the problems of one group under one deadline. Quantiles by nearest
/// rank (quantile.h); those "to target" run over all problems, the unsolved ones infinite.
struct SolverSummary {
  std::string solver;
  int problems = 0;  ///< with a best known cost or not; those nobody can solve count as well
  int solved = 0;    ///< by SolvedRule
  int feasible = 0;  ///< ended at a feasible point
  int refused = 0;   ///< the back end cannot solve problems of that kind
  int errors = 0;    ///< ended with an error
  double ms_to_target_median = 0.0, ms_to_target_p90 = 0.0, ms_to_target_p99 = 0.0;
  double evaluations_to_target_median = 0.0;
  /// Of the whole solve, whatever came out, over the problems it took; not a number if none.
  double ms_median = 0.0, ms_p90 = 0.0, ms_p99 = 0.0;
  double evaluations_median = 0.0, gradients_median = 0.0;
  double gap_median = 0.0;  ///< SolvedRule::gap of the results
  /// Past the deadline; 0 without one. [ms]
  double overrun_ms_p50 = 0.0, overrun_ms_p99 = 0.0, overrun_ms_max = 0.0;
  PerformanceProfile by_time, by_evaluations;  ///< to target
  GapCurve over_time, over_evaluations;
};

/// All back ends on one set, or on all of them together, under one deadline.
struct GroupSummary {
  std::string set;        ///< "all" for all sets together, which is there if there are several
  double deadline = 0.0;  ///< [s]; 0: none
  int problems = 0;
  std::vector<SolverSummary> solvers;  ///< in the order asked for
};

std::vector<GroupSummary> summarize(const BenchTable& table);

}  // namespace prospect
