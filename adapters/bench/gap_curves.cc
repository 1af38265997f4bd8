#include "adapters/bench/gap_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/support/quantile.h"

namespace prospect {
namespace {

/// The gap of the last improvement at or before `at`.
double gap_at(const BenchTable& table, const BenchRow& row, GapAxis axis, double at) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (row.stop == StopReason::kError) return kFar;
  const double best =
      table.best[static_cast<std::size_t>(row.set)][static_cast<std::size_t>(row.problem)].cost;
  const Improvement* last = nullptr;
  for (const Improvement& i : row.trace) {
    if ((axis == GapAxis::kSeconds ? i.seconds : i.evaluations) > at) break;
    last = &i;
  }
  if (!last || last->violation > kFeasible) return kFar;
  return table.rule(row.set).gap(last->cost, best);
}

}  // namespace

GapCurve gap_curve(const BenchTable& table, const std::vector<const BenchRow*>& rows, GapAxis axis,
                   double first, double last, int count) {
  GapCurve curve;
  if (rows.empty() || !(first > 0.0) || last < first) return curve;
  for (int i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / (count - 1) : 1.0;
    GapCurve::Point point;
    point.at = i + 1 == count ? last : first * std::pow(last / first, share);
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
