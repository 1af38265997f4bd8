// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/set_term.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "engine/terms/builtin_terms.h"
#include "tests/engine/planning_scene.h"

namespace prospect::set_term_test {
namespace {

TEST(SetTerm, EveryBuiltInCostHasItsWeight) {
  const TermRegistry terms = builtin_terms();
  PlannerParameters p;
  for (const auto& entry : terms.list()) {
    if (!entry->constraint) set_term(p, terms.use(entry->name, 0.123));
  }
  for (const double w : {p.weights.control_effort, p.weights.input_rate, p.weights.obstacles,
                         p.weights.visible_features, p.weights.exploration_gain,
                         p.weights.cost_to_go, p.weights.heading_alignment})
    EXPECT_EQ(w, 0.123);
  EXPECT_TRUE(p.terms.empty());
  EXPECT_TRUE(p.terms_left_out.empty());
}

TEST(SetTerm, WeightZeroLeavesABuiltInOneOutUntilItHasAnother) {
  const TermRegistry terms = builtin_terms();
  PlannerParameters p;
  set_term(p, terms.use("cost_to_go", 0.0));
  set_term(p, terms.use("rate_limit", 0.0));
  const test::PlanningScene scene("unicycle", p, 50);
  for (const auto& t : scene.problem->definition().terms) {
    EXPECT_NE(t.term->name(), "cost_to_go");
    EXPECT_NE(t.term->name(), "rate_limit");
  }
  set_term(p, terms.use("cost_to_go", 1.0));
  EXPECT_EQ(p.terms_left_out, std::vector<std::string>{"rate_limit"});
}

TEST(SetTerm, RefusesATermTwiceAndNone) {
  TermEntry entry{"mine", "mine"};
  entry.make = [](const TermOptions&, const TermContext&) { return nullptr; };
  TermRegistry registry;
  registry.add(entry);
  PlannerParameters p;
  set_term(p, registry.use("mine"));
  EXPECT_THROW(set_term(p, registry.use("mine", 2.0)), std::invalid_argument);
  EXPECT_THROW(set_term(p, TermUse{}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::set_term_test
