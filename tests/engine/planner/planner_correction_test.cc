// SPDX-License-Identifier: Apache-2.0
// A correction of the map moves what the robot was told, and nothing that it knows.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "engine/maps/correction.h"
#include "engine/planner/planner.h"
#include "engine/task/moved.h"
#include "models/make_model.h"
#include "tests/engine/planning_scene.h"
#include "tests/engine/room_belief.h"

namespace prospect::planner_correction_test {
namespace {

using test::Room;

std::shared_ptr<const MapFrame> frame_of(double x, double y, double yaw, int taken = 1) {
  auto frame = std::make_shared<MapFrame>();
  frame->origin = {{x, y, 0.0}, yaw};
  frame->taken = taken;
  frame->newest = TakenCorrection{0.0, std::hypot(x, y), yaw, 0.0, "SLAM"};
  return frame;
}

const double kTurn = M_PI / 6;

Zones zones() {
  Zones zones;
  zones.keep_out = {{{1.0, -0.6}, {1.6, -0.6}, {1.6, 0.6}, {1.0, 0.6}}};
  zones.slow = {{{{-2, -2}, {0, -2}, {0, 2}, {-2, 2}}, 0.2}};
  return zones;
}

class PlannerCorrection : public ::testing::Test {
 protected:
  RobotDescription robot_;
  Belief belief_ = Room{.seen = 6.0, .closed = true, .landmarks_per_wall = 20}.belief();

  PlannerCorrection() { robot_.model = make_model("unicycle"); }

  std::unique_ptr<Planner> planner(const Task& task, const Zones& zones) const {
    PlannerParameters p;
    p.N = 12;
    p.M = 6;
    p.max_landmarks = 40;
    p.max_targets = 60;
    p.task = task;
    p.zones = zones;
    return std::make_unique<Planner>(robot_, p, std::make_shared<test::IdleSolver>());
  }
  /// Drives what is planned.
  Plan step(Planner& planner) {
    belief_.command = belief_.twist;
    const Plan plan = planner.plan(belief_);
    const auto end = static_cast<std::size_t>(plan.committed);
    belief_.pose = robot_.model->pose(plan.states[end]);
    belief_.twist = plan.commands[end - 1];
    belief_.set_stamps(belief_.stamp + plan.committed * plan.dt);
    return plan;
  }
};

void expect_same(const Plan& a, const Plan& b) {
  ASSERT_EQ(a.states.size(), b.states.size());
  for (std::size_t k = 0; k < a.states.size(); ++k) EXPECT_EQ(a.states[k], b.states[k]);
  EXPECT_EQ(a.explanation.cost, b.explanation.cost);
  EXPECT_EQ(a.mode.kind, b.mode.kind);
}

// The one number that all of it comes down to: what was told in the map is what lies there in W.
TEST_F(PlannerCorrection, ToPlanInACorrectedMapIsToBeToldWhereThingsAreInW) {
  belief_.map_frame = frame_of(3.0, -1.0, kTurn);
  const Pose& T_MW = belief_.map_frame->origin;
  for (const Task& in_W :
       {Task::go_to({2.5, 1.5}, 0.4), Task::explore(Polygon{{-1, -1}, {4, -1}, {4, 4}, {-1, 4}})}) {
    const Task told = moved(in_W, T_MW);
    const auto corrected = planner(told, moved(zones(), T_MW));
    const Plan plan = corrected->plan(belief_);
    EXPECT_EQ(corrected->task().goal.position, told.goal.position);
    Belief same = belief_;
    same.map_frame = nullptr;
    const Pose T_WM = belief_.map_frame->map_in_W();
    expect_same(plan, planner(moved(told, T_WM), moved(moved(zones(), T_MW), T_WM))->plan(same));
    EXPECT_NE(plan.why.find("Correction: the map was corrected by 3.16 m and 30.0 degrees: SLAM."),
              std::string::npos)
        << plan.why;
    if (in_W.kind != TaskKind::kGoTo) continue;
    EXPECT_LT((plan.goal->position - in_W.goal.position).norm(), 1e-12);
    EXPECT_NEAR(*plan.goal->yaw, 0.4, 1e-12);
  }
}

TEST_F(PlannerCorrection, WhoWasToldNothingPlansTheSameToTheBit) {
  const auto one = planner(Task::explore(), {}), other = planner(Task::explore(), {});
  const Belief start = belief_;
  std::vector<Plan> plain;
  for (int n = 0; n < 4; ++n) plain.push_back(step(*one));
  belief_ = start;
  for (int n = 0; n < 4; ++n) {
    if (n >= 2) belief_.map_frame = frame_of(3.0, 0.4 * n, kTurn, n);
    expect_same(step(*other), plain[static_cast<std::size_t>(n)]);
  }
}

TEST_F(PlannerCorrection, TheStartWasMeasuredAndStays) {
  const auto planner = this->planner(Task::explore(), zones());
  step(*planner);
  belief_.map_frame = frame_of(3.0, 0.0, kTurn);
  planner->set_task(Task::return_to_start());
  const Plan plan = step(*planner);
  EXPECT_LT(plan.goal->position.norm(), 1e-9);
}

TEST_F(PlannerCorrection, WhatWasLearnedOfFrontiersIsKept) {
  Zones far;  // wherever the map goes
  far.keep_out = {{{40, 40}, {41, 40}, {41, 41}}};
  belief_ = Room{.seen = 3.0, .landmarks_per_wall = 20}.belief();
  const auto planner = this->planner(Task::explore(), far), other = this->planner({}, far);
  step(*planner);
  belief_ = Room{.seen = 3.0, .landmarks_per_wall = 20}.belief();
  step(*other);
  const Belief then = belief_;
  const Plan plain = step(*other);
  belief_ = then;
  belief_.map_frame = frame_of(3.0, 0.0, kTurn);
  const Plan plan = step(*planner);
  EXPECT_EQ(planner->global_plan()->facts.changed, TargetChange::kNone);
  EXPECT_EQ(planner->global_plan()->target->viewpoint, other->global_plan()->target->viewpoint);
  expect_same(plan, plain);
  EXPECT_NE(plan.why.find("Correction"), std::string::npos);
  EXPECT_EQ(step(*planner).why.find("Correction"), std::string::npos) << "told once";
}

// A keep-out that comes to lie on the robot does not move it, does not stop it, and is left.
TEST_F(PlannerCorrection, AKeepOutThatComesToLieOnTheRobotIsLeft) {
  Zones zones;
  zones.keep_out = {{{4.0, -0.5}, {5.0, -0.5}, {5.0, 0.5}, {4.0, 0.5}}};
  const auto planner = this->planner(Task::go_to({6.5, 1.5}), zones);
  const Guard guard = planner->make_guard();
  step(*planner);
  const double x = belief_.pose.position.x(), y = belief_.pose.position.y();
  belief_.map_frame = frame_of(4.4 - x, -y, 0.0);  // the robot is near the middle of it
  const ZoneMap map(zones);
  const BodyOutline body = body_outline(robot_.shape);
  const auto gap = [&] { return map.gap(0, body, belief_.map_frame->to_map(belief_.pose)); };
  EXPECT_LT(gap(), 0.0);
  double depth = -1e9;
  int steps = 0;
  for (; steps < 40 && gap() < 0.0; ++steps) {
    belief_.command = belief_.twist;
    const Plan plan = planner->plan(belief_);
    const GuardVerdict verdict = guard.check(plan, 0, belief_.twist, belief_, belief_.stamp);
    EXPECT_TRUE(verdict.passed()) << verdict.detail;
    step(*planner);
    const double now = map.distance(0, belief_.map_frame->to_map(belief_.pose.position.head<2>()));
    EXPECT_GE(now, depth - 1e-6) << "never deeper";
    depth = now;
  }
  EXPECT_LT(steps, 40) << "it got out";
  for (; steps < 60; ++steps) {
    step(*planner);
    EXPECT_GE(gap(), 0.0) << "and stays out";
  }
}

TEST_F(PlannerCorrection, APlanInFlightIsCertifiedAgainstWhereTheKeepOutIsNow) {
  Zones zones;
  zones.keep_out = {{{30, -1}, {31, -1}, {31, 1}, {30, 1}}};
  const auto planner = this->planner(Task::go_to({2.5, 0.0}), zones);
  const Guard guard = planner->make_guard();
  Plan plan;
  for (int n = 0; n < 4; ++n) plan = step(*planner);
  belief_.command = belief_.twist;
  plan = planner->plan(belief_);
  ASSERT_GT(plan.commands.front().linear.norm(), 0.1) << plan.why;
  EXPECT_TRUE(guard.check(plan, 0, belief_.twist, belief_, belief_.stamp).passed());
  // Just ahead of the robot now.
  const double ahead = belief_.pose.position.x() + 0.25;
  belief_.map_frame = frame_of(30.0 - ahead, 0.0, 0.0);
  const GuardVerdict verdict = guard.check(plan, 0, belief_.twist, belief_, belief_.stamp);
  EXPECT_EQ(verdict.reason, GuardReason::kForbidden) << verdict.detail;
  EXPECT_LT(verdict.command.linear.norm(), plan.commands.front().linear.norm());
}

TEST_F(PlannerCorrection, AGoalThatMovesToWhereNoneMayBeIsSaid) {
  Zones zones;
  zones.keep_out = {{{4.0, -0.5}, {5.0, -0.5}, {5.0, 0.5}, {4.0, 0.5}}};
  const auto planner = this->planner(Task::go_to({2.0, 0.0}), zones);
  step(*planner);
  belief_.map_frame = frame_of(-20.0, 0.0, 0.0);  // the goal is beyond the room's wall
  Plan plan = step(*planner);
  EXPECT_NE(plan.why.find("Correction"), std::string::npos);
  for (int n = 0; n < 30 && plan.mode.kind != ModeKind::kDone; ++n) plan = step(*planner);
  EXPECT_EQ(plan.fault, PlanFault::kNone);
  EXPECT_TRUE(plan.certified) << plan.why;
}

}  // namespace
}  // namespace prospect::planner_correction_test
