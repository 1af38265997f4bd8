// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/safety_level.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace prospect::safety_level_test {
namespace {

TEST(SafetyLevel, Table) {
  struct Case {
    bool stuck, lost, narrow, fixed_lost_margin;
    SafetyLevel expected;
  };
  for (const Case& c : {
           Case{false, false, false, false, SafetyLevel::kNormal},
           Case{false, false, false, true, SafetyLevel::kNormal},
           Case{false, false, true, false, SafetyLevel::kReduced},
           Case{true, false, false, false, SafetyLevel::kStuck},
           // A robot that is stuck in a narrow passage had better give it up than creep on.
           Case{true, false, true, false, SafetyLevel::kReduced},
           Case{false, true, false, false, SafetyLevel::kLost},
           Case{false, true, true, false, SafetyLevel::kLost},
           Case{true, true, false, false, SafetyLevel::kStuck},
           Case{true, true, true, false, SafetyLevel::kLost},
           Case{true, true, false, true, SafetyLevel::kLost},
       }) {
    Facts facts;
    facts.stuck = c.stuck;
    facts.localization = c.lost ? Localization::kLost : Localization::kOk;
    facts.frontiers = FrontierFacts{.narrow = c.narrow};
    EXPECT_EQ(safety_level_for(facts, c.fixed_lost_margin), c.expected)
        << c.stuck << c.lost << c.narrow << c.fixed_lost_margin;
  }
  EXPECT_EQ(safety_level_for({}, false), SafetyLevel::kNormal) << "before the frontiers are known";
}

// Several conditions may hold at once: the order of the rows decides, and no row is in vain.
TEST(SafetyLevel, EachRowDecidesSomewhereAndTheLastHoldsAlways) {
  const auto table = safety_level_table();
  std::vector<int> decided(table.size());
  for (int bits = 0; bits < 16; ++bits) {
    Facts facts;
    facts.stuck = (bits & 1) != 0;
    facts.localization = (bits & 2) != 0 ? Localization::kLost : Localization::kOk;
    facts.frontiers = FrontierFacts{.narrow = (bits & 4) != 0};
    const SafetyLevelRow::Case c{facts, (bits & 8) != 0};
    std::size_t first = 0;
    while (!table[first].holds(c)) ++first;
    ++decided[first];
    EXPECT_EQ(table[first].safety_level, safety_level_for(facts, c.fixed_lost_margin)) << bits;
    EXPECT_TRUE(table.back().holds(c)) << bits;
  }
  for (std::size_t row = 0; row < table.size(); ++row) {
    EXPECT_GT(decided[row], 0) << table[row].condition;
  }
}

TEST(SafetyLevel, EachHasItsPolicyAndNoneAllowsMoreThanTheGuard) {
  for (const SafetyLevel safety_level : kSafetyLevels) {
    EXPECT_EQ(policy(safety_level).safety_level, safety_level);
    // A guard asks for a quarter of the margin (PlannerParameters::guard_margin()).
    EXPECT_GT(policy(safety_level).margin, 0.25);
  }
}

}  // namespace
}  // namespace prospect::safety_level_test
