// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_summary.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/adapters/bench_example.h"

namespace prospect::bench_summary_test {
namespace {

TEST(BenchSummary, ShiftedGeometricMeansCountTheUnsolvedAsTheLongest) {
  const BenchTable t = test::bench_example(2);
  const GroupSummary group = summarize(t).front();
  // "fast": 10 and 10.1 ms; 20 evaluations each.
  EXPECT_NEAR(group.solvers[0].geometric_ms.mean, std::sqrt(11.0 * 11.1) - 1.0, 1e-9);
  EXPECT_NEAR(group.solvers[0].geometric_evaluations.mean, 20.0, 1e-9);
  // "slow" does not solve the first: the longest solve of all is its own second, 101 ms.
  EXPECT_NEAR(group.solvers[1].geometric_ms.mean, 101.0, 1e-9);
  EXPECT_NEAR(group.solvers[1].geometric_evaluations.mean, 200.0, 1e-9);
}

TEST(BenchSummary, RanksAreByBackEndAndShared) {
  BenchTable t = test::bench_example(4);
  const GroupSummary group = summarize(t).front();
  EXPECT_EQ(group.solvers[0].rank_by_time.mean, 1.0);
  EXPECT_EQ(group.solvers[1].rank_by_time.mean, 2.0);
  EXPECT_EQ(group.solvers[1].solved_share.mean, 0.75);
  EXPECT_EQ(group.solvers[0].optima, 4);
  EXPECT_EQ(group.solvers[1].optima, 0);
  // Where nobody solves it, both have rank 1.5.
  for (BenchRow& row : t.rows) {
    if (row.problem == 0) row.cost = 9.0, row.trace.back().cost = 9.0;
  }
  judge(t);
  EXPECT_EQ(summarize(t).front().solvers[0].rank_by_evaluations.mean, (1.5 + 1.0 + 1.0 + 1.0) / 4);
}

TEST(BenchSummary, SeedsOfAProblemCountOnceInIntervals) {
  // Many seeds of few problems make no interval narrower: every seed gives the same here.
  const auto one = summarize(test::bench_example(4)).front().solvers[1].solved_share;
  const auto many =
      summarize(test::bench_example(4, 1.0, {1, 2, 3})).front().solvers[1].solved_share;
  EXPECT_EQ(one.mean, many.mean);
  EXPECT_EQ(one.low, many.low);
  EXPECT_EQ(one.high, many.high);
}

TEST(TargetCurve, RisesFromTheTargetsOfTheFirstPointToAll) {
  const GroupSummary group = summarize(test::bench_example(4)).front();
  const auto& fast = group.solvers[0].targets_over_evaluations.points;
  const auto& slow = group.solvers[1].targets_over_evaluations.points;
  ASSERT_FALSE(fast.empty());
  // The first point has a cost of 2, a gap of 1: it reaches one of the 25 targets.
  EXPECT_NEAR(fast.front().share.mean, 1.0 / 25.0, 1e-12);
  EXPECT_EQ(fast.back().share.mean, 1.0);
  EXPECT_EQ(slow.back().at, fast.back().at);
  // The gap of the unsolved one is 0.5: targets 1 and 0.562 are reached.
  EXPECT_NEAR(slow.back().share.mean, (3.0 + 2.0 / 25.0) / 4.0, 1e-12);
  EXPECT_LT(slow.back().share.low, slow.back().share.mean);
  for (std::size_t i = 1; i < slow.size(); ++i) {
    EXPECT_GE(slow[i].share.mean, slow[i - 1].share.mean);
  }
}

}  // namespace
}  // namespace prospect::bench_summary_test
