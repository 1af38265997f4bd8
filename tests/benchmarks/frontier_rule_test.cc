#include "benchmarks/frontier_rule.h"

#include <gtest/gtest.h>

#include <limits>

namespace prospect::frontier_rule_test {
namespace {

TEST(FrontierRule, NearestTakesTheLeastDistanceWhateverTheLength) {
  EXPECT_EQ(choose_frontier(FrontierRule::kNearest, {{4, 3.0, 9.0}, {1, 2.0, 0.5}, {7, 2.5, 50.0}}),
            1);
}

TEST(FrontierRule, CostUtilityWeighsThreeMetresOfPathAgainstNineOfLength) {
  const auto choose = [](double farther, double longer) {
    return choose_frontier(FrontierRule::kCostUtility,
                           {{0, 2.0, 1.0}, {1, 2.0 + farther, 1.0 + longer}});
  };
  EXPECT_EQ(choose(3.0, 8.9), 0);
  EXPECT_EQ(choose(3.0, 9.1), 1);
}

TEST(FrontierRule, TakesTheFirstOfEqualOnesAndNoneOfNone) {
  for (const FrontierRule rule : {FrontierRule::kNearest, FrontierRule::kCostUtility}) {
    EXPECT_EQ(choose_frontier(rule, {{5, 2.0, 1.0}, {3, 2.0, 1.0}}), 5);
    EXPECT_EQ(choose_frontier(rule, {}), -1);
    EXPECT_EQ(choose_frontier(rule, {{5, std::numeric_limits<double>::infinity(), 1.0}}), -1);
  }
}

}  // namespace
}  // namespace prospect::frontier_rule_test
