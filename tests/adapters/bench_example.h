// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/bench/bench_table.h"

namespace prospect::test {

/// A judged table of two back ends on `problems` problems with best known cost 1, without a
/// deadline: "fast" solves problem p at 10 ms and 20 evaluations times `factor`, "slow" in ten
/// times as much and never problem 0.
inline BenchTable bench_example(int problems = 8, double factor = 1.0,
                                std::vector<int> seeds = {1}) {
  BenchTable t;
  t.sets = {{"set", "known", 1e-3, {}}};
  t.solvers = {"fast", "slow"};
  t.seeds = std::move(seeds);
  t.environments = {{{"processor", "abacus"}, {"build", {{"commit", "c0ffee"}}}}};
  for (int p = 0; p < problems; ++p) {
    t.sets[0].problems.push_back({"p" + std::to_string(p), 2, 0, "00" + std::to_string(p), 1.0});
    for (const int seed : t.seeds) {
      for (int k = 0; k < 2; ++k) {
        BenchRow row;
        row.problem = p;
        row.solver = k;
        row.seed = seed;
        row.stop = StopReason::kConverged;
        row.claimed = row.quality = k == 0 ? Quality::kFeasibleOptimum : Quality::kFeasible;
        row.optimality = 1e-4;
        row.x = Eigen::Vector2d(1.0, p);
        row.cost = k == 1 && p == 0 ? 1.5 : 1.0;
        row.violation = 0.0;
        const double times = factor * (k == 0 ? 1.0 : 10.0);
        row.seconds = 0.01 * times * (1.0 + 0.01 * p);
        row.repeat_seconds = {row.seconds};
        row.counters = {static_cast<int>(20.0 * times), static_cast<int>(20.0 * times), 3};
        row.trace = {{0.1 * row.seconds, 1, 2.0, 0.0},
                     {row.seconds, row.counters.cost_evaluations, row.cost, 0.0}};
        t.rows.push_back(row);
      }
    }
  }
  judge(t);
  return t;
}

}  // namespace prospect::test
