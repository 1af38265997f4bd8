#include "engine/behaviour/caution.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace prospect::caution_test {
namespace {

TEST(Caution, Table) {
  struct Case {
    bool stuck, lost, narrow, fixed_lost_margin;
    Caution expected;
  };
  for (const Case& c : {
           Case{false, false, false, false, Caution::kNormal},
           Case{false, false, false, true, Caution::kNormal},
           Case{false, false, true, false, Caution::kReduced},
           Case{true, false, false, false, Caution::kStuck},
           // A robot that is stuck in a narrow passage had better give it up than creep on.
           Case{true, false, true, false, Caution::kReduced},
           Case{false, true, false, false, Caution::kLost},
           Case{false, true, true, false, Caution::kLost},
           Case{true, true, false, false, Caution::kStuck},
           Case{true, true, true, false, Caution::kLost},
           Case{true, true, false, true, Caution::kLost},
       }) {
    Facts facts;
    facts.stuck = c.stuck;
    facts.localization = c.lost ? Localization::kLost : Localization::kOk;
    facts.frontiers = FrontierFacts{.narrow = c.narrow};
    EXPECT_EQ(caution_for(facts, c.fixed_lost_margin), c.expected)
        << c.stuck << c.lost << c.narrow << c.fixed_lost_margin;
  }
  EXPECT_EQ(caution_for({}, false), Caution::kNormal) << "before the frontiers are known";
}

// Several conditions may hold at once: the order of the rows decides, and no row is in vain.
TEST(Caution, EachRowDecidesSomewhereAndTheLastHoldsAlways) {
  const auto table = caution_table();
  std::vector<int> decided(table.size());
  for (int bits = 0; bits < 16; ++bits) {
    Facts facts;
    facts.stuck = (bits & 1) != 0;
    facts.localization = (bits & 2) != 0 ? Localization::kLost : Localization::kOk;
    facts.frontiers = FrontierFacts{.narrow = (bits & 4) != 0};
    const CautionRow::Case c{facts, (bits & 8) != 0};
    std::size_t first = 0;
    while (!table[first].holds(c)) ++first;
    ++decided[first];
    EXPECT_EQ(table[first].caution, caution_for(facts, c.fixed_lost_margin)) << bits;
    EXPECT_TRUE(table.back().holds(c)) << bits;
  }
  for (std::size_t row = 0; row < table.size(); ++row) {
    EXPECT_GT(decided[row], 0) << table[row].condition;
  }
}

TEST(Caution, EachHasItsPolicyAndNoneAllowsMoreThanTheGuard) {
  for (const Caution caution : kCautions) {
    EXPECT_EQ(policy(caution).caution, caution);
    // A guard asks for a quarter of the margin (PlannerParameters::guard_margin()).
    EXPECT_GT(policy(caution).margin, 0.25);
  }
}

}  // namespace
}  // namespace prospect::caution_test
