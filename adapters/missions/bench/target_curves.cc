// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/target_curves.h"

#include <cmath>

namespace prospect {

const std::vector<double>& gap_targets() {
  static const std::vector<double> targets = [] {
    std::vector<double> all;
    for (int i = 0; i <= 24; ++i) all.push_back(std::pow(10.0, -0.25 * i));
    return all;
  }();
  return targets;
}

Eigen::VectorXd by_problem(const std::vector<const BenchRow*>& rows,
                           const std::vector<double>& values) {
  std::vector<double> sums;
  std::vector<int> counts;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool same =
        i > 0 && rows[i]->set == rows[i - 1]->set && rows[i]->problem == rows[i - 1]->problem;
    if (!same) {
      sums.push_back(0.0);
      counts.push_back(0);
    }
    sums.back() += values[i];
    ++counts.back();
  }
  Eigen::VectorXd means(static_cast<Eigen::Index>(sums.size()));
  for (std::size_t p = 0; p < sums.size(); ++p) {
    means[static_cast<Eigen::Index>(p)] = sums[p] / counts[p];
  }
  return means;
}

TargetCurve target_curve(const BenchTable& table, const std::vector<const BenchRow*>& rows,
                         GapAxis axis, double first, double last, int count,
                         const ResampledMeans& means) {
  TargetCurve curve;
  const std::vector<double> places = curve_places(first, last, count);
  if (rows.empty() || places.empty()) return curve;
  Eigen::MatrixXd shares;
  for (std::size_t k = 0; k < places.size(); ++k) {
    std::vector<double> reached;
    for (const BenchRow* row : rows) {
      const double gap = gap_at(table, *row, axis, places[k]);
      int count_reached = 0;
      for (const double target : gap_targets()) count_reached += gap <= target;
      reached.push_back(static_cast<double>(count_reached) /
                        static_cast<double>(gap_targets().size()));
    }
    const Eigen::VectorXd of_problems = by_problem(rows, reached);
    if (k == 0) shares.resize(of_problems.size(), static_cast<Eigen::Index>(places.size()));
    shares.col(static_cast<Eigen::Index>(k)) = of_problems;
  }
  const std::vector<MeanInterval> intervals = means.intervals(shares);
  for (std::size_t k = 0; k < places.size(); ++k) curve.points.push_back({places[k], intervals[k]});
  return curve;
}

}  // namespace prospect
