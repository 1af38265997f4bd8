// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/frontier_rule.h"

#include <gtest/gtest.h>

#include <limits>

namespace prospect::frontier_rule_test {
namespace {

FrontierCandidate candidate(double path, double length) {
  return {.frontier = 9, .area = 1.0, .path = path, .length = length};
}

TEST(FrontierRule, NearestTakesTheLeastDistanceWhateverTheLength) {
  EXPECT_EQ(choose_frontier(FrontierRule::kNearest,
                            {candidate(3.0, 9.0), candidate(2.0, 0.5), candidate(2.5, 50.0)}),
            1);
}

TEST(FrontierRule, CostUtilityWeighsThreeMetresOfPathAgainstNineOfLength) {
  const auto choose = [](double farther, double longer) {
    return choose_frontier(FrontierRule::kCostUtility,
                           {candidate(2.0, 1.0), candidate(2.0 + farther, 1.0 + longer)});
  };
  EXPECT_EQ(choose(3.0, 8.9), 0);
  EXPECT_EQ(choose(3.0, 9.1), 1);
}

TEST(FrontierRule, TakesTheFirstOfEqualOnesAndNoneOfNone) {
  for (const FrontierRule rule : {FrontierRule::kNearest, FrontierRule::kCostUtility}) {
    EXPECT_EQ(choose_frontier(rule, {candidate(2.0, 1.0), candidate(2.0, 1.0)}), 0);
    EXPECT_EQ(choose_frontier(rule, {}), -1);
    EXPECT_EQ(choose_frontier(rule, {candidate(std::numeric_limits<double>::infinity(), 1.0)}), -1);
  }
}

}  // namespace
}  // namespace prospect::frontier_rule_test
