// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "models/range_text.h"

namespace prospect {

double ProblemFacts::difference(double best) const {
  const double fallen = std::abs(start_cost - best);
  return std::isfinite(fallen) ? std::max(fallen, cost_change) : cost_change;
}

bool feasible(const BenchRow& row) {
  return row.supported && row.stop != StopReason::kError && row.quality != Quality::kNone &&
         row.violation <= kFeasible;
}

std::string words_of(const BenchTable& table, const BenchRow& row) {
  return "'" + table.solver_of(row) + "' on '" + table.problem_of(row).name + "' of " +
         table.set_of(row).name + ", " +
         (row.deadline > 0.0 ? "deadline " + exact_text(row.deadline) + " s" : "no deadline") +
         ", seed " + std::to_string(row.seed);
}

std::string to_string(SolveClock clock) { return clock == SolveClock::kWall ? "wall" : "cpu"; }

double waited(const BenchTable& table) {
  double wall = 0.0, processor = 0.0;
  for (const BenchRow& row : table.rows) {
    wall += row.wall_seconds;
    processor += row.processor_seconds;
  }
  return wall > 0.0 ? std::max(0.0, 1.0 - processor / wall) : 0.0;
}

std::string busy_sentence(const BenchTable& table) {
  const double share = waited(table);
  if (!(share > kMostWaited)) return "";
  const std::string percent = std::to_string(std::lround(100.0 * share));
  return "measured on a busy machine: solves waited " + percent + " % of the time for a processor" +
         (table.clock == SolveClock::kWall
              ? "; deadlines struck early, times are not to be compared (--clock cpu)"
              : ", which is not counted");
}

int environment_index(BenchTable& table, const nlohmann::ordered_json& environment) {
  auto& all = table.environments;
  const auto same = std::find(all.begin(), all.end(), environment);
  const auto index = static_cast<int>(same - all.begin());
  if (same == all.end()) all.push_back(environment);
  return index;
}

void judge(BenchTable& table) {
  table.best.clear();
  for (const ProblemSetFacts& set : table.sets) {
    std::vector<BestKnown> best(set.problems.size());
    for (std::size_t p = 0; p < best.size(); ++p) {
      if (set.problems[p].best_known) best[p] = {*set.problems[p].best_known, "stored"};
    }
    table.best.push_back(std::move(best));
  }
  // Where one row shows that the cost still falls at a bound that nobody stated, none has solved
  // it.
  std::map<std::pair<int, int>, double> falls_to;
  for (const BenchRow& row : table.rows) {
    if (!feasible(row)) continue;
    if (row.held) {
      double& least = falls_to.try_emplace({row.set, row.problem}, row.cost).first->second;
      least = std::min(least, row.cost);
      continue;
    }
    BestKnown& best =
        table.best[static_cast<std::size_t>(row.set)][static_cast<std::size_t>(row.problem)];
    if (row.cost < best.cost) best = {row.cost, table.solver_of(row)};
  }
  for (BenchRow& row : table.rows) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    row.solved = false;
    row.gap = row.seconds_to_target = row.evaluations_to_target = kNever;
    if (!feasible(row) || row.held) continue;
    double best = table.best_of(row).cost;
    if (const auto least = falls_to.find({row.set, row.problem}); least != falls_to.end()) {
      best = std::min(best, least->second);
    }
    const SolvedRule rule = table.rule(row);
    row.solved = rule.solved(row.cost, row.violation, best);
    row.gap = rule.gap(row.cost, best);
    for (const Improvement& i : row.trace) {
      if (!rule.solved(i.cost, i.violation, best)) continue;
      row.seconds_to_target = i.seconds;
      row.evaluations_to_target = i.evaluations;
      break;
    }
  }
}

void sort_rows(BenchTable& table) {
  const auto place = [](const auto& list, const auto& value) {
    return std::find(list.begin(), list.end(), value) - list.begin();
  };
  const auto key = [&](const BenchRow& row) {
    return std::tuple(row.set, row.problem, place(table.deadlines, row.deadline),
                      place(table.seeds, row.seed), row.solver);
  };
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [&](const BenchRow& a, const BenchRow& b) { return key(a) < key(b); });
}

}  // namespace prospect
