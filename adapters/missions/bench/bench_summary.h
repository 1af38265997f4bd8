// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/bench/bench_table.h"
#include "adapters/missions/bench/gap_curves.h"
#include "adapters/missions/bench/performance_profile.h"
#include "adapters/missions/bench/resampled_means.h"
#include "adapters/missions/bench/target_curves.h"

namespace prospect {

/// What one back end did with the problems of one group under one deadline. A problem counts once
/// for each seed. Quantiles by nearest rank (quantile.h); those "to target" run over all problems,
/// the unsolved ones infinite. Intervals are over the problems, seeds of one together.
struct SolverSummary {
  std::string solver;
  int problems = 0;  ///< with a best known cost or not; those nobody can solve count as well
  int solved = 0;    ///< by SolvedRule
  int feasible = 0;  ///< ended at a feasible point
  int optima = 0;    ///< Quality::kFeasibleOptimum, verified
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
  MeanInterval solved_share;
  /// Shifted geometric means, exp(mean log(v + s)) - s, of time (s = 1 ms) and evaluations (s = 10)
  /// to target; an unsolved problem counts as the largest that any back end of the group spent on
  /// any problem, solved or not, or the deadline if that is longer.
  MeanInterval geometric_ms, geometric_evaluations;
  /// Mean rank among the back ends by time and by evaluations to target, 1 the best; equal ones
  /// share the mean of their ranks, and so do those that did not solve a problem.
  MeanInterval rank_by_time, rank_by_evaluations;
  PerformanceProfile by_time, by_evaluations;  ///< to target
  GapCurve over_time, over_evaluations;
  TargetCurve targets_over_time, targets_over_evaluations;
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
