// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/support/quantile.h"

namespace prospect {
namespace {

using Rows = std::vector<const BenchRow*>;

constexpr int kCurvePoints = 61;

template <typename Get>
std::vector<double> column(const Rows& rows, Get get) {
  std::vector<double> values;
  for (const BenchRow* row : rows) values.push_back(get(*row));
  return values;
}

SolverSummary summary_of(const std::string& solver, const Rows& rows) {
  SolverSummary s;
  s.solver = solver;
  s.problems = static_cast<int>(rows.size());
  Rows taken;
  for (const BenchRow* row : rows) {
    s.solved += row->solved;
    s.feasible += std::isfinite(row->gap);
    s.optima += row->supported && row->quality == Quality::kFeasibleOptimum;
    s.refused += !row->supported;
    s.errors += row->supported && row->stop == StopReason::kError;
    if (row->supported) taken.push_back(row);
  }
  const auto to_target = column(rows, [](auto& r) { return 1e3 * r.seconds_to_target; });
  s.ms_to_target_median = quantile(to_target, 0.5);
  s.ms_to_target_p90 = quantile(to_target, 0.9);
  s.ms_to_target_p99 = quantile(to_target, 0.99);
  s.evaluations_to_target_median =
      quantile(column(rows, [](auto& r) { return r.evaluations_to_target; }), 0.5);
  const auto ms = column(taken, [](auto& r) { return 1e3 * r.seconds; });
  s.ms_median = quantile(ms, 0.5);
  s.ms_p90 = quantile(ms, 0.9);
  s.ms_p99 = quantile(ms, 0.99);
  const auto count = [](int n) { return static_cast<double>(n); };
  s.evaluations_median =
      quantile(column(taken, [&](auto& r) { return count(r.counters.cost_evaluations); }), 0.5);
  s.gradients_median =
      quantile(column(taken, [&](auto& r) { return count(r.counters.gradient_evaluations); }), 0.5);
  s.gap_median = quantile(column(rows, [](auto& r) { return r.gap; }), 0.5);
  const auto overrun = column(taken, [](auto& r) { return 1e3 * r.overrun; });
  if (!overrun.empty()) {
    s.overrun_ms_p50 = quantile(overrun, 0.5);
    s.overrun_ms_p99 = quantile(overrun, 0.99);
    s.overrun_ms_max = quantile(overrun, 1.0);
  }
  return s;
}

/// Mean ranks of equal values: measures by back end, problem -> the same shape.
std::vector<std::vector<double>> ranks_of(const std::vector<std::vector<double>>& measures) {
  std::vector<std::vector<double>> ranks = measures;
  for (std::size_t p = 0; !measures.empty() && p < measures.front().size(); ++p) {
    for (std::size_t k = 0; k < measures.size(); ++k) {
      int before = 0, equal = 0;
      for (const std::vector<double>& other : measures) {
        before += other[p] < measures[k][p];
        equal += other[p] == measures[k][p];
      }
      ranks[k][p] = before + 0.5 * (equal + 1);
    }
  }
  return ranks;
}

MeanInterval shifted_geometric(const Rows& rows, std::vector<double> values, double unsolved,
                               double shift, const ResampledMeans& means) {
  for (double& value : values) value = std::log((std::isfinite(value) ? value : unsolved) + shift);
  const MeanInterval logs = means.interval(by_problem(rows, values));
  return {std::exp(logs.mean) - shift, std::exp(logs.low) - shift, std::exp(logs.high) - shift};
}

GroupSummary group_of(const BenchTable& table, const std::string& name, double deadline,
                      const std::vector<Rows>& by_solver) {
  GroupSummary group;
  group.set = name;
  group.deadline = deadline;
  group.problems = static_cast<int>(by_solver.front().size());
  // The curves of all back ends span the same times and evaluations.
  double first_s = std::numeric_limits<double>::infinity(), last_s = 0.0, last_e = 1.0;
  std::vector<std::vector<double>> times, evaluations;
  for (std::size_t k = 0; k < by_solver.size(); ++k) {
    group.solvers.push_back(summary_of(table.solvers[k], by_solver[k]));
    // Ratios need measures above zero, whatever a clock or a back end's counter says.
    times.push_back(
        column(by_solver[k], [](auto& r) { return std::max(r.seconds_to_target, 1e-9); }));
    evaluations.push_back(
        column(by_solver[k], [](auto& r) { return std::max(r.evaluations_to_target, 1.0); }));
    for (const BenchRow* row : by_solver[k]) {
      if (row->trace.empty()) continue;
      first_s = std::min(first_s, std::max(row->trace.front().seconds, 1e-6));
      last_s = std::max(last_s, row->seconds);
      last_e = std::max(last_e, static_cast<double>(row->counters.cost_evaluations));
    }
  }
  const auto by_time = performance_profiles(times);
  const auto by_evaluations = performance_profiles(evaluations);
  const auto time_ranks = ranks_of(times), evaluation_ranks = ranks_of(evaluations);
  const std::vector<double> ones(by_solver.front().size(), 1.0);
  const ResampledMeans means(static_cast<int>(by_problem(by_solver.front(), ones).size()));
  const double longest_ms = 1e3 * std::max(last_s, deadline);
  for (std::size_t k = 0; k < by_solver.size(); ++k) {
    SolverSummary& s = group.solvers[k];
    const Rows& rows = by_solver[k];
    const auto mean_of = [&](const std::vector<double>& values) {
      return means.interval(by_problem(rows, values));
    };
    s.solved_share = mean_of(column(rows, [](auto& r) { return r.solved ? 1.0 : 0.0; }));
    s.geometric_ms =
        shifted_geometric(rows, column(rows, [](auto& r) { return 1e3 * r.seconds_to_target; }),
                          longest_ms, 1.0, means);
    s.geometric_evaluations = shifted_geometric(
        rows, column(rows, [](auto& r) { return r.evaluations_to_target; }), last_e, 10.0, means);
    s.rank_by_time = mean_of(time_ranks[k]);
    s.rank_by_evaluations = mean_of(evaluation_ranks[k]);
    s.by_time = by_time[k];
    s.by_evaluations = by_evaluations[k];
    if (!std::isfinite(first_s)) continue;
    s.over_time = gap_curve(table, by_solver[k], GapAxis::kSeconds, first_s, last_s, kCurvePoints);
    s.over_evaluations =
        gap_curve(table, by_solver[k], GapAxis::kEvaluations, 1.0, last_e, kCurvePoints);
    s.targets_over_time =
        target_curve(table, rows, GapAxis::kSeconds, first_s, last_s, kCurvePoints, means);
    s.targets_over_evaluations =
        target_curve(table, rows, GapAxis::kEvaluations, 1.0, last_e, kCurvePoints, means);
  }
  return group;
}

}  // namespace

std::vector<GroupSummary> summarize(const BenchTable& table) {
  std::vector<GroupSummary> groups;
  const int sets = static_cast<int>(table.sets.size());
  // -1: all sets together.
  for (int set = sets > 1 ? -1 : 0; set < sets; ++set) {
    for (const double deadline : table.deadlines) {
      std::vector<Rows> by_solver(table.solvers.size());
      for (const BenchRow& row : table.rows) {
        if ((set >= 0 && row.set != set) || row.deadline != deadline) continue;
        by_solver[static_cast<std::size_t>(row.solver)].push_back(&row);
      }
      if (by_solver.empty() || by_solver.front().empty()) continue;
      const std::string name = set < 0 ? "all" : table.sets[static_cast<std::size_t>(set)].name;
      groups.push_back(group_of(table, name, deadline, by_solver));
    }
  }
  return groups;
}

}  // namespace prospect
