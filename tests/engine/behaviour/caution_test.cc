#include "engine/behaviour/caution.h"

#include <gtest/gtest.h>

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

TEST(Caution, EachHasItsPolicyAndNoneAllowsMoreThanTheGuard) {
  for (const Caution caution : kCautions) {
    EXPECT_EQ(policy(caution).caution, caution);
    // A guard asks for a quarter of the margin (PlannerParameters::guard_margin()).
    EXPECT_GT(policy(caution).margin, 0.25);
  }
}

}  // namespace
}  // namespace prospect::caution_test
