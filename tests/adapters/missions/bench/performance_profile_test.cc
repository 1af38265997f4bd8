// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/performance_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "adapters/missions/bench/solved_rule.h"

namespace prospect::performance_profile_test {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

TEST(PerformanceProfile, IsTheOneComputedByHand) {
  // Four problems; ratios of A: 1, 2, never, never; of B: 3, 1, 1, never.
  const auto profiles = performance_profiles({{1.0, 4.0, kNever, kNever}, {3.0, 2.0, 5.0, kNever}});
  ASSERT_EQ(profiles.size(), 2U);
  const PerformanceProfile &a = profiles[0], &b = profiles[1];
  EXPECT_EQ(a.at(0.99), 0.0);
  EXPECT_EQ(a.at(1.0), 0.25);
  EXPECT_EQ(a.at(1.99), 0.25);
  EXPECT_EQ(a.at(2.0), 0.5);
  EXPECT_EQ(a.at(1e9), 0.5);
  EXPECT_EQ(b.at(1.0), 0.5);
  EXPECT_EQ(b.at(2.99), 0.5);
  EXPECT_EQ(b.at(3.0), 0.75);
  EXPECT_EQ(b.at(1e9), 0.75);
  EXPECT_EQ(a.steps.size(), 2U);
  EXPECT_EQ(b.steps.size(), 2U);
}

TEST(PerformanceProfile, OfASolverThatSolvesNothingHasNoStep) {
  const auto profiles = performance_profiles({{kNever, kNever}, {1.0, kNever}});
  EXPECT_TRUE(profiles[0].steps.empty());
  EXPECT_EQ(profiles[1].at(1.0), 0.5);
  EXPECT_TRUE(performance_profiles({}).empty());
  EXPECT_TRUE(performance_profiles({{}, {}})[0].steps.empty());
}

TEST(SolvedRule, TakesAShareOfTheBestOrAnAbsoluteSlack) {
  const SolvedRule rule{0.01, 0.001};
  EXPECT_TRUE(rule.solved(101.0, 0.0, 100.0));
  EXPECT_FALSE(rule.solved(101.01, 0.0, 100.0));
  EXPECT_TRUE(rule.solved(-99.0, 0.0, -100.0));
  EXPECT_FALSE(rule.solved(-98.99, 0.0, -100.0));
  EXPECT_TRUE(rule.solved(0.0009, 0.0, 0.0));
  EXPECT_FALSE(rule.solved(0.0011, 0.0, 0.0));
  EXPECT_TRUE(rule.solved(50.0, kFeasible, 100.0));
  EXPECT_FALSE(rule.solved(50.0, 1.01 * kFeasible, 100.0));
}

TEST(SolvedRule, HasAGapThatIsTheShareWhereItIsJustSolved) {
  const SolvedRule rule{0.01, 0.001};
  EXPECT_DOUBLE_EQ(rule.gap(101.0, 100.0), 0.01);
  EXPECT_DOUBLE_EQ(rule.gap(rule.target(0.0), 0.0), 0.01);
  EXPECT_DOUBLE_EQ(rule.gap(-50.0, -100.0), 0.5);
  EXPECT_EQ(rule.gap(99.0, 100.0), 0.0);
}

}  // namespace
}  // namespace prospect::performance_profile_test
