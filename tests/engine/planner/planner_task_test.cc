// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/planner/planner.h"
#include "models/make_model.h"
#include "tests/engine/planning_scene.h"
#include "tests/engine/room_belief.h"

namespace prospect::planner_task_test {
namespace {

using test::Room;

PlannerParameters small_parameters() {
  PlannerParameters p;
  p.N = 12;
  p.M = 6;
  p.max_landmarks = 40;
  p.max_targets = 60;
  return p;
}

/// A robot that drives its plans exactly in a room of which all that is to be known is known.
class PlannerTask : public ::testing::Test {
 protected:
  PlannerParameters parameters_ = small_parameters();
  RobotDescription robot_;
  std::unique_ptr<Planner> planner_;
  Belief belief_ = Room{.seen = 6.0, .closed = true, .landmarks_per_wall = 20}.belief();
  std::vector<Pose> driven_;

  PlannerTask() { robot_.model = make_model("unicycle"); }

  void make() {
    planner_ = std::make_unique<Planner>(robot_, parameters_, std::make_shared<test::IdleSolver>());
  }
  Plan step() {
    belief_.command = belief_.twist;
    const Plan plan = planner_->plan(belief_);
    const auto end = static_cast<std::size_t>(plan.committed);
    for (std::size_t k = 1; k <= end; ++k) {
      driven_.push_back(robot_.model->pose(plan.states[k]));
      speeds_.push_back(plan.commands[k - 1].linear.norm());
    }
    belief_.pose = robot_.model->pose(plan.states[end]);
    belief_.twist = plan.commands[end - 1];
    belief_.set_stamps(belief_.stamp + plan.committed * plan.dt);
    return plan;
  }
  /// Until the mode is done; the last plan.
  Plan until_done(double most) {
    Plan plan;
    const double start = belief_.stamp;
    do {
      plan = step();
    } while (plan.mode.kind != ModeKind::kDone && belief_.stamp - start < most);
    return plan;
  }
  double distance_to(double x, double y) const {
    return (belief_.pose.position.head<2>() - Eigen::Vector2d(x, y)).norm();
  }
  std::vector<double> speeds_;
};

TEST_F(PlannerTask, TakesTheFrontiersThatWerePrepared) {
  belief_ = Room{.seen = 3.0, .landmarks_per_wall = 20}.belief();
  make();
  belief_.set_stamps(1.0);
  planner_->prepare(belief_);
  belief_.set_stamps(1.2);
  Plan plan = step();
  EXPECT_EQ(plan.stamp, 1.2);
  EXPECT_TRUE(plan.certified) << plan.detail;
  EXPECT_TRUE(plan.has_active_frontier) << plan.why;
  EXPECT_EQ(planner_->global_plan()->stamp, 1.0);
  const double next = belief_.stamp;
  step();
  EXPECT_EQ(planner_->global_plan()->stamp, next) << "each is taken once";
}

TEST_F(PlannerTask, FromTheSameBeliefAPreparedStepIsThatOfAnother) {
  belief_ = Room{.seen = 3.0, .landmarks_per_wall = 20}.belief();
  belief_.command = belief_.twist;
  make();
  const Plan expected = planner_->plan(belief_);
  make();
  planner_->prepare(belief_);
  const Plan plan = planner_->plan(belief_);
  ASSERT_EQ(plan.inputs.size(), expected.inputs.size());
  for (std::size_t k = 0; k < plan.inputs.size(); ++k)
    EXPECT_EQ(plan.inputs[k], expected.inputs[k]);
  EXPECT_EQ(plan.why, expected.why);
}

TEST_F(PlannerTask, WhatWasPreparedForAnotherTaskIsDropped) {
  belief_ = Room{.seen = 3.0, .landmarks_per_wall = 20}.belief();
  make();
  belief_.set_stamps(1.0);
  planner_->prepare(belief_);
  EXPECT_EQ(planner_->set_task(Task::go_to({2.0, 0.5}, 0.0)), "");
  belief_.set_stamps(1.2);
  planner_->prepare(belief_);
  belief_.set_stamps(1.4);
  EXPECT_TRUE(step().goal);
  EXPECT_EQ(planner_->global_plan()->stamp, 1.4) << "the arrival is judged where the robot is";
  planner_->prepare(Belief());
  belief_.set_stamps(1.6);
  EXPECT_TRUE(step().certified) << "a belief that lacks a map prepares nothing";
}

TEST_F(PlannerTask, GoesToAPoseAndReturns) {
  parameters_.task = Task::go_to({4.5, 0.8}, -1.2);
  make();
  EXPECT_EQ(planner_->task().kind, TaskKind::kGoTo);
  const Plan there = until_done(60.0);
  EXPECT_EQ(there.mode.cause, Cause::kGoalReached) << there.why;
  EXPECT_EQ(there.task, TaskKind::kGoTo);
  ASSERT_TRUE(there.goal);
  EXPECT_EQ(there.goal->position, Eigen::Vector2d(4.5, 0.8));
  EXPECT_LT(distance_to(4.5, 0.8), 0.2);
  EXPECT_LT(std::abs(std::remainder(belief_.pose.yaw + 1.2, 2.0 * M_PI)), 0.25);
  EXPECT_LT(belief_.stamp, 30.0);
  // It stays there.
  for (int n = 0; n < 6; ++n) EXPECT_EQ(step().mode.kind, ModeKind::kDone);
  EXPECT_LT(belief_.twist.linear.norm(), 1e-3);
  EXPECT_LT(distance_to(4.5, 0.8), 0.2);

  EXPECT_EQ(planner_->set_task(Task::return_to_start()), "");
  EXPECT_EQ(step().mode.kind, ModeKind::kReturn);
  const Plan back = until_done(60.0);
  EXPECT_EQ(back.mode.cause, Cause::kReturned) << back.why;
  EXPECT_LT(distance_to(0.0, 0.0), 0.2);
  EXPECT_LT(std::abs(std::remainder(belief_.pose.yaw, 2.0 * M_PI)), 0.25);
}

TEST_F(PlannerTask, HoldsAndGoesOn) {
  belief_ = Room{.seen = 4.0, .landmarks_per_wall = 20}.belief();
  make();
  for (int n = 0; n < 3; ++n) EXPECT_EQ(step().mode.kind, ModeKind::kExplore);
  EXPECT_GT(belief_.twist.linear.norm() + std::abs(belief_.twist.yaw_rate), 0.1);
  EXPECT_EQ(planner_->set_task(Task::hold()), "");
  for (int n = 0; n < 4; ++n) {
    const Plan plan = step();
    EXPECT_EQ(plan.mode.kind, ModeKind::kHold);
    EXPECT_EQ(plan.mode.cause, Cause::kTaskGiven);
    EXPECT_TRUE(plan.certified) << plan.detail;
  }
  EXPECT_LT(belief_.twist.linear.norm(), 1e-9);
  EXPECT_LT(std::abs(belief_.twist.yaw_rate), 1e-9);
  // The time in between is none in which frontiers were not reached.
  belief_.set_stamps(belief_.stamp + 1000.0);
  EXPECT_EQ(step().mode.kind, ModeKind::kHold);
  EXPECT_EQ(planner_->set_task(Task::explore()), "");
  const Plan plan = step();
  EXPECT_EQ(plan.mode.kind, ModeKind::kExplore);
  EXPECT_EQ(plan.mode.cause, Cause::kTaskGiven);
  EXPECT_LT(planner_->global_plan()->facts.stalled_for, 3.0);
  EXPECT_TRUE(plan.has_active_frontier);
}

TEST_F(PlannerTask, SaysWithinSecondsThatAGoalCannotBeReached) {
  parameters_.task = Task::go_to({8.0, 0.0});  // behind the room's far wall
  make();
  const Plan plan = until_done(60.0);
  EXPECT_EQ(plan.mode.cause, Cause::kGoalUnreachable);
  EXPECT_LE(belief_.stamp, 10.0);
  EXPECT_NE(plan.why.find("the goal cannot be reached: what is known"), std::string::npos)
      << plan.why;
  // In a wall, likewise; another goal then is another matter.
  EXPECT_EQ(planner_->set_task(Task::go_to({3.0, 1.95})), "");
  const double before = belief_.stamp;
  const Plan wall = until_done(60.0);
  EXPECT_LE(belief_.stamp, before + 10.0);
  EXPECT_NE(wall.why.find("in a wall"), std::string::npos) << wall.why;
  EXPECT_EQ(planner_->set_task(Task::go_to({3.0, 1.0})), "");
  EXPECT_EQ(until_done(60.0).mode.cause, Cause::kGoalReached);
}

TEST_F(PlannerTask, GoesRoundAKeepOutAndSlowlyThroughAZone) {
  parameters_.task = Task::go_to({5.0, 0.0});
  parameters_.zones.keep_out = {{{2.4, -0.6}, {3.0, -0.6}, {3.0, 1.9}, {2.4, 1.9}}};
  parameters_.zones.slow = {{{{3.6, -2}, {4.4, -2}, {4.4, 2}, {3.6, 2}}, 0.15}};
  belief_ = Room{.seen = 6.0, .box = false, .closed = true, .landmarks_per_wall = 20}.belief();
  make();
  const Plan plan = until_done(90.0);
  EXPECT_EQ(plan.mode.cause, Cause::kGoalReached) << plan.why << belief_.pose.position.transpose();
  const ZoneMap zones(parameters_.zones);
  double fastest = 0.0;
  int slow = 0;
  for (std::size_t k = 0; k < driven_.size(); ++k) {
    const Eigen::Vector2d p = driven_[k].position.head<2>();
    EXPECT_GE(zones.distance(p), 0.18) << p.transpose();
    if (zones.speed_limit(p) > 1.0) {
      fastest = std::max(fastest, speeds_[k]);
      continue;
    }
    ++slow;
    EXPECT_LE(speeds_[k], 0.15 + 2e-4) << p.transpose();
  }
  EXPECT_GT(slow, 10);
  EXPECT_GT(fastest, 0.3);
}

TEST_F(PlannerTask, ExploresWithinItsArea) {
  belief_ = Room{.seen = 4.0, .landmarks_per_wall = 20}.belief();
  parameters_.task = Task::explore(Polygon{{-1, -2}, {3, -2}, {3, 2}, {-1, 2}});
  make();
  const Plan plan = until_done(30.0);
  EXPECT_EQ(plan.mode.cause, Cause::kExplored) << plan.why;
  EXPECT_LE(belief_.stamp, 12.0);
  EXPECT_EQ(planner_->set_task(Task::explore()), "");
  const Plan on = step();
  EXPECT_EQ(on.mode.kind, ModeKind::kExplore);
  EXPECT_TRUE(on.has_active_frontier);
}

// All that is known is 2 m of the room; the area begins farther on.
TEST_F(PlannerTask, AnAreaThatDoesNotTouchWhatIsKnownIsAGoalToGetTo) {
  belief_ = Room{.seen = 2.0, .landmarks_per_wall = 20}.belief();
  parameters_.task = Task::explore(Polygon{{4, -2}, {6, -2}, {6, 2}, {4, 2}});
  make();
  const Plan plan = step();
  EXPECT_EQ(plan.mode.kind, ModeKind::kExplore);
  EXPECT_NE(plan.why.find("to the area that is to be explored"), std::string::npos) << plan.why;
  ASSERT_TRUE(planner_->global_plan()->target);
  EXPECT_GT(planner_->global_plan()->facts.unknown_left, 1.0);
  EXPECT_FALSE(plan.goal);
  for (int n = 0; n < 6; ++n) step();
  EXPECT_GT(belief_.pose.position.x(), 0.5) << "it sets out";
  // Beyond the world, in a zone, and behind one: nothing of it can be seen, and it is said why.
  const auto end = [&](const Polygon& area) {
    belief_ = Room{.seen = 2.0, .landmarks_per_wall = 20}.belief();
    parameters_.task = Task::explore(area);
    parameters_.frontier_planner.traversability.extent =
        Eigen::AlignedBox2d(Eigen::Vector2d(-3, -3), Eigen::Vector2d(8, 3));
    make();
    const Plan last = until_done(30.0);
    EXPECT_EQ(last.mode.cause, Cause::kUnreachable) << last.why;
    EXPECT_LE(belief_.stamp, 10.0);
    return last.why;
  };
  EXPECT_NE(end({{9, -2}, {12, -2}, {12, 2}}).find("outside of the world"), std::string::npos);
  parameters_.zones.keep_out = {{{4, -5}, {6, -5}, {6, 5}, {4, 5}}};
  EXPECT_NE(end({{4.5, -2}, {5.5, -2}, {5.5, 2}}).find("forbidden, by zones.keep_out[0]"),
            std::string::npos);
  EXPECT_NE(end({{6.5, -2}, {7.5, -2}, {7.5, 2}}).find("zones.keep_out[0] bars every way"),
            std::string::npos);
}

TEST_F(PlannerTask, ZonesChangeBetweenTwoPlans) {
  parameters_.task = Task::go_to({5.0, 0.0});
  belief_ = Room{.seen = 6.0, .box = false, .closed = true, .landmarks_per_wall = 20}.belief();
  make();
  for (int n = 0; n < 4; ++n) step();
  EXPECT_GT(belief_.pose.position.x(), 0.3);
  Zones zones;
  zones.keep_out = {{{2.4, -2.0}, {3.0, -2.0}, {3.0, 2.0}, {2.4, 2.0}}};
  EXPECT_EQ(planner_->set_zones(zones), "");
  const Plan plan = until_done(60.0);
  EXPECT_EQ(plan.mode.cause, Cause::kGoalUnreachable) << plan.why;
  EXPECT_LT(belief_.pose.position.x(), 2.23);
  EXPECT_EQ(planner_->set_zones({}), "");
  EXPECT_EQ(until_done(60.0).mode.cause, Cause::kGoalReached);
}

TEST_F(PlannerTask, WhatIsWrongIsSaidAndChangesNothing) {
  parameters_.zones.keep_out = {{{2, -1}, {3, -1}, {3, 1}, {2, 1}}};
  make();
  const std::string said = planner_->set_task(Task::go_to({2.5, 0.0}));
  EXPECT_EQ(said.find("goal: is in zones.keep_out[0]; expected"), 0u) << said;
  EXPECT_EQ(planner_->task().kind, TaskKind::kExplore);
  Zones wrong;
  wrong.slow = {{{{0, 0}, {1, 0}, {1, 1}}, -1.0}};
  EXPECT_EQ(planner_->set_zones(wrong).find("slow[0]: max_speed is -1"), 0u);
  EXPECT_EQ(planner_->parameters().zones.keep_out.size(), 1u);
  parameters_.task = Task::go_to({2.5, 0.0});
  EXPECT_THROW(make(), std::invalid_argument);
  parameters_.task = {};
  parameters_.zones = wrong;
  EXPECT_THROW(make(), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::planner_task_test
