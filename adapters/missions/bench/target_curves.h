// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/missions/bench/bench_table.h"
#include "adapters/missions/bench/gap_curves.h"
#include "adapters/missions/bench/resampled_means.h"

namespace prospect {

/// Gaps (SolvedRule::gap) that count as targets: 25, from 1 down to 1e-6, evenly spread in
/// logarithm.
const std::vector<double>& gap_targets();

/// The share of (problem, target) pairs that a back end has reached, as it goes on: an empirical
/// distribution function of runtimes.
struct TargetCurve {
  struct Point {
    double at = 0.0;     ///< [s], or evaluations
    MeanInterval share;  ///< over the problems (resampled_means.h)
  };
  std::vector<Point> points;
};

/// The curve of rows of one back end at the same places as gap_curve(). Rows of the same problem
/// (several seeds) stand together and count as one problem. `means`: of as many problems.
TargetCurve target_curve(const BenchTable& table, const std::vector<const BenchRow*>& rows,
                         GapAxis axis, double first, double last, int count,
                         const ResampledMeans& means);

/// Mean over the rows of each problem: `values` by row.
Eigen::VectorXd by_problem(const std::vector<const BenchRow*>& rows,
                           const std::vector<double>& values);

}  // namespace prospect
