// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/added_terms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/planner/set_term.h"
#include "engine/terms/builtin_terms.h"
#include "tests/engine/planning_scene.h"

namespace prospect::added_terms_test {
namespace {

using testing::HasSubstr;

enum class Fault { kNone, kNanValue, kNanGradient, kThrows, kNanSometimes };

/// -x of the last node [m].
class EndX final : public Term {
 public:
  explicit EndX(Fault fault) : fault_(fault) {}
  std::string_view name() const override { return "end_x"; }
  TermTraits traits() const override { return {}; }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    if (fault_ == Fault::kThrows) throw std::runtime_error("lost the thread");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const int N = t.horizon.N;
    for (int b = 0; b < t.batch(); ++b) {
      const double x = t.px(N, b);
      out.value(0, b) =
          fault_ == Fault::kNanValue || (fault_ == Fault::kNanSometimes && x < -0.5) ? nan : -x;
      if (request.gradient) {
        out.add_pose_gradient(t, N, b, fault_ == Fault::kNanGradient ? nan : -1.0, 0.0, 0.0, 0.0);
      }
    }
  }

 private:
  Fault fault_;
};

TermUse end_x(TermEntry::Factory make, double weight = 1.0) {
  TermEntry entry{"end_x", "where it ends"};
  entry.make = std::move(make);
  TermRegistry registry;
  registry.add(entry);
  return registry.use("end_x", weight);
}

TermUse end_x(Fault fault, double weight = 1.0) {
  return end_x(
      [fault](const TermOptions&, const TermContext&) { return std::make_shared<EndX>(fault); },
      weight);
}

Plan plan_with(const std::vector<TermUse>& uses,
               std::shared_ptr<const Problem>* problem = nullptr) {
  PlannerParameters parameters;
  for (const TermUse& use : uses) set_term(parameters, use);
  const test::PlanningScene scene("unicycle", parameters, 50);
  if (problem) *problem = scene.problem;
  Belief belief = scene.belief;
  belief.stamp = 0.5;
  return scene.planner->plan(belief);
}

const TermValue* value_of(const Plan& plan, const std::string& name) {
  for (const TermValue& term : plan.explanation.terms) {
    if (term.name == name) return &term;
  }
  return nullptr;
}

TEST(AddedTerms, CountInThePlanAfterTheBuiltInOnes) {
  const Plan plan = plan_with({end_x(Fault::kNone, 30.0)});
  EXPECT_TRUE(plan.certified);
  EXPECT_EQ(plan.detail, "");
  ASSERT_EQ(plan.explanation.terms.back().name, "end_x");
  EXPECT_NEAR(plan.explanation.terms.back().weighted, 30.0 * plan.explanation.terms.back().raw,
              1e-12);
  EXPECT_GT(plan.states.back().x(), plan_with({}).states.back().x() + 0.1) << "it pulls";
}

TEST(AddedTerms, WithWeightZeroAreNone) {
  std::shared_ptr<const Problem> with, without;
  plan_with({end_x(Fault::kNone, 0.0)}, &with);
  plan_with({}, &without);
  EXPECT_EQ(with->definition().terms.size(), without->definition().terms.size());
}

TEST(AddedTerms, OneThatFailsIsLeftOutAndToldOf) {
  const Plan without = plan_with({});
  struct Case {
    TermUse use;
    std::string why;
  };
  const std::vector<Case> cases = {
      {end_x(Fault::kNanValue), "term 'end_x': its value is a finite number at no seed"},
      {end_x(Fault::kNanGradient), "term 'end_x': its gradient is no finite number"},
      {end_x(Fault::kThrows),
       "term 'end_x': its value is a finite number at no seed, or it throws"},
      {end_x([](const TermOptions&, const TermContext&) -> std::shared_ptr<const Term> {
         throw std::runtime_error("no map");
       }),
       "term 'end_x': its factory failed: no map"},
      {end_x([](const TermOptions&, const TermContext&) -> std::shared_ptr<const Term> {
         return nullptr;
       }),
       "made nothing"},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.why);
    const Plan plan = plan_with({c.use});
    EXPECT_THAT(plan.detail, HasSubstr(c.why));
    EXPECT_THAT(plan.why, HasSubstr(c.why));
    EXPECT_TRUE(plan.certified);
    ASSERT_EQ(plan.inputs.size(), without.inputs.size());
    for (std::size_t k = 0; k < plan.inputs.size(); ++k) {
      EXPECT_EQ(plan.inputs[k], without.inputs[k]) << "as without it";
    }
    const TermValue* value = value_of(plan, "end_x");
    ASSERT_NE(value, nullptr);
    EXPECT_TRUE(std::isnan(value->raw));
    EXPECT_EQ(value->weighted, 0.0);
  }
}

TEST(AddedTerms, OneThatFailsAtSomeCandidatesRejectsThoseAlone) {
  const Plan plan = plan_with({end_x(Fault::kNanSometimes)});
  EXPECT_EQ(plan.detail, "");
  EXPECT_TRUE(plan.certified);
  EXPECT_GE(plan.states.back().x(), -0.5);
  EXPECT_LT(plan_with({}).states.back().x(), -0.5) << "where it would go else";
}

TEST(AddedTerms, ThatNoRegistryMadeAreRefused) {
  PlannerParameters parameters;
  parameters.terms = {TermUse{}};
  RobotDescription robot;
  robot.model = make_model("unicycle");
  const auto solver = std::make_shared<test::IdleSolver>();
  EXPECT_THROW(Planner(robot, parameters, solver), std::invalid_argument);
  parameters.terms = {end_x(Fault::kNone)};
  parameters.terms[0].weight = -1.0;
  EXPECT_THROW(Planner(robot, parameters, solver), std::invalid_argument);
  parameters.terms = {builtin_terms().use("cost_to_go")};
  EXPECT_THROW(Planner(robot, parameters, solver), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::added_terms_test
