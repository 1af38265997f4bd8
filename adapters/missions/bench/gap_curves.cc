// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/gap_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/support/quantile.h"

namespace prospect {

std::vector<double> curve_places(double first, double last, int count) {
  std::vector<double> places;
  if (!(first > 0.0) || last < first) return places;
  for (int i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / (count - 1) : 1.0;
    places.push_back(i + 1 == count ? last : first * std::pow(last / first, share));
  }
  return places;
}

double gap_at(const BenchTable& table, const BenchRow& row, GapAxis axis, double at) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (row.stop == StopReason::kError || row.held) return kFar;
  const double best = table.best_of(row).cost;
  const Improvement* last = nullptr;
  for (const Improvement& i : row.trace) {
    if ((axis == GapAxis::kSeconds ? i.seconds : i.evaluations) > at) break;
    last = &i;
  }
  if (!last || last->violation > kFeasible) return kFar;
  return table.rule(row).gap(last->cost, best);
}

GapCurve gap_curve(const BenchTable& table, const std::vector<const BenchRow*>& rows, GapAxis axis,
                   double first, double last, int count) {
  GapCurve curve;
  if (rows.empty()) return curve;
  for (const double at : curve_places(first, last, count)) {
    GapCurve::Point point;
    point.at = at;
    std::vector<double> gaps;
    for (const BenchRow* row : rows) gaps.push_back(gap_at(table, *row, axis, point.at));
    point.lower = quantile(gaps, 0.25);
    point.median = quantile(gaps, 0.5);
    point.upper = quantile(gaps, 0.75);
    curve.points.push_back(point);
  }
  return curve;
}

}  // namespace prospect
