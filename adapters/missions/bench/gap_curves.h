// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/missions/bench/bench_table.h"

namespace prospect {

/// How far from the best known a back end is, as it goes on: quartiles over the problems.
struct GapCurve {
  struct Point {
    double at = 0.0;  ///< [s], or evaluations
    /// SolvedRule::gap of the incumbent: a quarter, half, three quarters of the problems are at
    /// most this far from the best. Infinite where so many have no feasible point yet. [-]
    double lower = 0.0, median = 0.0, upper = 0.0;
  };
  std::vector<Point> points;
};

enum class GapAxis { kSeconds, kEvaluations };

/// `count` places that are evenly spread in logarithm from `first` to `last`, both included; none
/// unless 0 < first <= last.
std::vector<double> curve_places(double first, double last, int count);

/// SolvedRule::gap of the incumbent of a row at that time, or after so many evaluations. A row that
/// has ended keeps its last one. Infinite without a feasible point, or if the back end failed.
double gap_at(const BenchTable& table, const BenchRow& row, GapAxis axis, double at);

/// The curve of rows of one back end (of one deadline; one or several sets) at curve_places(). No
/// points without rows.
GapCurve gap_curve(const BenchTable& table, const std::vector<const BenchRow*>& rows, GapAxis axis,
                   double first, double last, int count);

}  // namespace prospect
