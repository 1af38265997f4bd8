// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/plan_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/engine/planning_scene.h"

namespace prospect::plan_choice_test {
namespace {

std::shared_ptr<const ZoneMap> keep_out_ahead() {
  Zones zones;
  zones.keep_out = {{{0.8, 0.1}, {1.3, 0.1}, {1.3, 0.8}, {0.8, 0.8}}};
  return zone_map_of(zones);
}

class PlanChoice : public ::testing::Test {
 protected:
  PlanChoice() {
    update_clearance(*scene_.planner->specification(), evaluators_);
    update_views(*scene_.planner->specification(), evaluators_);
    // Full speed ahead: into the keep-out sooner or later, so the longer part is refused.
    const Problem& problem = *scene_.problem;
    fast_ = {"fast", problem.upper(), 1.0, 0.0};
    for (Eigen::Index i = 1; i < fast_.z.size(); i += 2) fast_.z[i] = 0.0;
    for (const Seed& seed : make_stop_seeds(problem))
      stop_ = {seed.name, seed.z, 5.0, 0.0, {}, 0.0, 0.0, seed.stops};
  }
  bool choose(const std::vector<Candidate>& candidates, int committed, Plan& plan) {
    return choose_certified(candidates,
                            {scene_.belief, *scene_.problem, certifier_, SafetyLevel::kNormal,
                             drift_, *evaluators_.visible_features, committed, late_},
                            plan);
  }

  test::PlanningScene scene_{"unicycle"};
  CachedEvaluators evaluators_;
  std::shared_ptr<const ZoneMap> zones_ = keep_out_ahead();
  PlanCertifier certifier_{scene_.planner->robot(), scene_.planner->parameters(), zones_};
  SurfaceDrift drift_;
  Candidate fast_, stop_;
  StopCondition late_;
};

TEST_F(PlanChoice, TheFirstCertifiedOneBecomesThePlan) {
  Plan plan;
  ASSERT_TRUE(choose({fast_, stop_}, 20, plan));
  EXPECT_EQ(plan.seed, "stop") << "20 stages at full speed lead into the keep-out";
  EXPECT_TRUE(plan.certified);
  EXPECT_EQ(plan.kind, PlanKind::kSeed);
  EXPECT_EQ(plan.committed, 20);
  EXPECT_EQ(plan.commands.size(), 20U);
  EXPECT_EQ(plan.states.size(), 21U);
  EXPECT_EQ(plan.visible.size(), 21U);
  EXPECT_FALSE(plan.explanation.terms.empty());
  ASSERT_EQ(plan.candidates.size(), 2U);
  EXPECT_NE(plan.candidates[0].verdict.kind, Verdict::Kind::kExecuted);
  EXPECT_EQ(plan.candidates[1].verdict.kind, Verdict::Kind::kExecuted);
}

TEST_F(PlanChoice, WhatComesAfterItIsNotTried) {
  Plan plan;
  ASSERT_TRUE(choose({stop_, fast_}, 2, plan));
  ASSERT_EQ(plan.candidates.size(), 2U);
  EXPECT_EQ(plan.candidates[1].verdict.kind, Verdict::Kind::kNotTried);
}

TEST_F(PlanChoice, TenAreTriedAndStoppingWhateverItsRank) {
  std::vector<Candidate> candidates(15, fast_);
  Plan plan;
  EXPECT_FALSE(choose(candidates, 20, plan));
  EXPECT_FALSE(plan.certificate.empty());
  EXPECT_TRUE(plan.commands.empty());
  EXPECT_EQ(plan.candidates.size(), 5U);
  candidates.push_back(stop_);
  plan = {};
  EXPECT_TRUE(choose(candidates, 20, plan));
  EXPECT_EQ(plan.seed, "stop");
  candidates.back().stops = false;  // its name says nothing
  plan = {};
  EXPECT_FALSE(choose(candidates, 20, plan)) << "the eleventh and later ones";
}

TEST_F(PlanChoice, OnceItIsLateOneIsTriedAndTheStop) {
  late_ = deadline(0.0);
  Plan plan;
  ASSERT_TRUE(choose({fast_, fast_, stop_}, 20, plan));
  EXPECT_EQ(plan.seed, "stop");
  ASSERT_EQ(plan.candidates.size(), 3u);
  EXPECT_NE(plan.candidates[0].verdict.kind, Verdict::Kind::kNotTried);
  EXPECT_EQ(plan.candidates[1].verdict.kind, Verdict::Kind::kNotTried);
  Plan first;
  ASSERT_TRUE(choose({stop_, fast_}, 20, first));
  EXPECT_EQ(first.seed, "stop");
}

TEST_F(PlanChoice, ThePlanHoldsTheStopAfterItsCommittedPart) {
  Plan plan;
  ASSERT_TRUE(choose({fast_, stop_}, 1, plan));
  ASSERT_EQ(plan.seed, "fast");
  ASSERT_FALSE(plan.tail.empty());
  EXPECT_EQ(plan.tail.back().linear.norm(), 0.0);
  double speed = plan.commands[0].linear.norm();
  for (const Twist& command : plan.tail) {
    EXPECT_LT(command.linear.norm(), speed + 1e-12);
    speed = command.linear.norm();
  }
  EXPECT_FALSE(plan.ramp_from);
}

// Told what it was measured to drive, a base would be told more than it can.
TEST(PlanOfAFastRobot, CommandsAreWithinTheModelsLimits) {
  for (const std::string& name : model_names()) {
    SCOPED_TRACE(name);
    test::PlanningScene scene{name};
    const MotionModel& model = *scene.planner->robot().model;
    scene.belief.twist.linear.x() = 1.3 * model.max_speed();
    scene.belief.twist.yaw_rate = -1.3 * model.max_yaw_rate();
    for (const bool told : {false, true}) {
      if (told) scene.belief.command = scene.belief.twist;
      const Plan plan = scene.planner->plan(scene.belief);
      EXPECT_EQ(plan.fault, PlanFault::kNone) << plan.detail;
      std::vector<Twist> twists = plan.commands;
      twists.insert(twists.end(), plan.tail.begin(), plan.tail.end());
      if (plan.ramp_from) twists.push_back(*plan.ramp_from);
      EXPECT_FALSE(twists.empty());
      for (const Twist& twist : twists) {
        EXPECT_LE(twist.linear.norm(), (1.0 + 1e-9) * model.max_speed()) << plan.certified;
        EXPECT_LE(std::abs(twist.yaw_rate), model.max_yaw_rate()) << plan.certified;
      }
    }
  }
}

}  // namespace
}  // namespace prospect::plan_choice_test
