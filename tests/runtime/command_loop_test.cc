// SPDX-License-Identifier: Apache-2.0
#include "runtime/command_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "models/unicycle.h"
#include "tests/engine/obstacle_worlds.h"

namespace prospect::command_loop_test {
namespace {

constexpr double kPeriod = 0.05;

Twist twist(double v, double w = 0.0) { return {{v, 0.0, 0.0}, w}; }

/// Two stages are committed: speeding up to 0.2 and 0.4 m/s; then the stop.
std::shared_ptr<Plan> plan_from(double stamp) {
  auto plan = std::make_shared<Plan>();
  plan->kind = PlanKind::kOptimised;
  plan->stamp = stamp;
  plan->commands = {twist(0.2), twist(0.4)};
  plan->inputs = {Eigen::Vector2d(0.2, 0.0), Eigen::Vector2d(0.4, 0.0)};
  plan->committed = 2;
  plan->tail = {twist(0.2), twist(0.0)};
  plan->certified = true;
  return plan;
}

class CommandLoopTest : public ::testing::Test {
 protected:
  void SetUp() override {
    in_.now = 10.0;
    in_.base.connected = true;
    in_.drive = {DriveResponse::kFull, 1.0};
    world_ = test::ObstacleWorld().belief();
  }
  /// A step at the time of in_, from a fresh belief at the pose that follows from the commands.
  CommandStep step() {
    in_.base.stamp = in_.now;
    if (known_) {
      Belief belief = world_;
      belief.pose = pose_;
      belief.set_stamps(in_.now);
      in_.belief = std::make_shared<const Belief>(belief);
    } else {
      in_.belief.reset();
    }
    const CommandStep step = loop_.step(in_);
    EXPECT_DOUBLE_EQ(step.expires, in_.now + 0.15);
    pose_ = predicted_pose(pose_, in_.now, {{{in_.now, step.command}}}, in_.now + kPeriod, {});
    in_.now += kPeriod;
    return step;
  }
  std::vector<double> speeds(int count) {
    std::vector<double> v;
    for (int k = 0; k < count; ++k) v.push_back(step().command.linear.x());
    return v;
  }

  std::shared_ptr<const Unicycle> model_ = std::make_shared<const Unicycle>();
  Guard guard_{model_, CylinderShape{}, [] {
                 Certifier::Options options;
                 options.slice = {0.1, 0.5};
                 return options;
               }()};
  CommandLoop loop_{model_, guard_, {}};
  CommandInputs in_;
  Belief world_;
  Pose pose_;
  bool known_ = true;
};

TEST_F(CommandLoopTest, RampsAlongThePlanThenBrakesAndRests) {
  in_.plan = plan_from(10.0);
  // 0.8 m/s^2: 0.04 m/s in a period.
  const std::vector<double> v = speeds(24);
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(v[k], 0.04 * (k + 1), 1e-9);
  EXPECT_NEAR(v[9], 0.4, 1e-9);    // 10.45
  EXPECT_NEAR(v[10], 0.36, 1e-9);  // past the committed part
  EXPECT_NEAR(v[18], 0.04, 1e-9);
  for (int k = 19; k < 24; ++k) EXPECT_EQ(v[k], 0.0);
}

TEST_F(CommandLoopTest, SaysWhy) {
  EXPECT_EQ(step().reason, CommandReason::kNoPlan);
  in_.plan = plan_from(in_.now);
  EXPECT_EQ(step().reason, CommandReason::kPlan);
  known_ = false;
  EXPECT_EQ(step().reason, CommandReason::kNoBelief);
  known_ = true;
  in_.range_share = 0.0;
  EXPECT_EQ(step().reason, CommandReason::kObstacle);
  in_.range_share = 1.0;
  in_.drive = {DriveResponse::kComfortStop, 0.0};
  EXPECT_EQ(step().reason, CommandReason::kComfortStop);
  in_.drive = {DriveResponse::kStand, 0.0};
  EXPECT_EQ(step().reason, CommandReason::kStand);
  in_.drive = {DriveResponse::kEmergencyStop, 0.0};
  const CommandStep emergency = step();
  EXPECT_EQ(emergency.reason, CommandReason::kEmergencyStop);
  EXPECT_TRUE(emergency.stop);
  in_.base.faults = {"bumper pressed"};
  EXPECT_EQ(step().detail, "the base reports: bumper pressed");
  in_.base.connected = false;
  EXPECT_EQ(step().reason, CommandReason::kBase);
  EXPECT_TRUE(step().stop);
  in_.base.faults.clear();
  EXPECT_EQ(step().detail, "the base is not connected");
}

TEST_F(CommandLoopTest, RemembersTheLastSeconds) {
  in_.plan = plan_from(10.0);
  speeds(100);
  EXPECT_LE(loop_.state().sent.size(), 62U);
}

// The stop that is foretold ends: then it rests.
TEST(CommandsUntil, RestsAfterTheStopThatIsForetold) {
  CommandState state;
  state.command = twist(0.3);
  state.stop = {twist(0.2), twist(0.1), twist(0.5)};
  state.stop.pop_back();
  const auto commands = commands_until(Unicycle(), state, 10.0, 10.2, kPeriod);
  ASSERT_EQ(commands.size(), 4U);
  EXPECT_EQ(commands[1].command.linear.x(), 0.1);
  EXPECT_EQ(commands[2].command.linear.x(), 0.0);
}

TEST_F(CommandLoopTest, WhateverForbidsDrivingItBrakes) {
  in_.plan = plan_from(10.0);
  speeds(8);
  const double before = loop_.state().command.linear.x();
  in_.drive = {DriveResponse::kComfortStop, 0.0};
  EXPECT_NEAR(step().command.linear.x(), before - 0.04, 1e-9);
  known_ = false;
  EXPECT_NEAR(step().command.linear.x(), before - 0.08, 1e-9);
}

TEST_F(CommandLoopTest, WhatStandsIsNotSetInMotionByARamp) {
  in_.plan = plan_from(10.0);
  speeds(8);
  in_.drive = {DriveResponse::kEmergencyStop, 0.0};
  EXPECT_TRUE(step().stop);  // the base may stop faster than the model brakes
  in_.drive = {DriveResponse::kStand, 0.0};
  EXPECT_EQ(step().command.linear.norm(), 0.0);
  EXPECT_FALSE(loop_.state().plan) << "what does not drive has no plan in force";
}

TEST_F(CommandLoopTest, DrivesSlowerThatIsAShareOfThePlan) {
  in_.plan = plan_from(10.0);
  in_.drive = {DriveResponse::kSlow, 0.5};
  EXPECT_NEAR(speeds(10).back(), 0.2, 1e-9);
}

// Plans that are made as early as they may be: each comes as the one before it begins.
TEST_F(CommandLoopTest, APlanThatBeginsIsNotLostToItsSuccessor) {
  in_.plan = plan_from(10.5);
  speeds(10);
  for (int k = 1; k <= 4; ++k) {
    in_.plan = plan_from(10.5 + 0.5 * k);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(step().reason, CommandReason::kPlan) << in_.now;
  }
  EXPECT_GT(loop_.state().command.linear.x(), 0.3);
}

TEST_F(CommandLoopTest, APlanTakesEffectAtItsStamp) {
  in_.plan = plan_from(10.0);
  speeds(6);  // until 10.3
  auto next = plan_from(10.4);
  next->commands = {twist(0.1), twist(0.1)};
  in_.plan = next;
  const std::vector<double> v = speeds(3);
  EXPECT_NEAR(v[1], 0.32, 1e-9);  // 10.35, still the first plan
  EXPECT_NEAR(v[2], 0.28, 1e-9);  // 10.4
}

TEST_F(CommandLoopTest, ALatePlanIsNotDriven) {
  in_.plan = plan_from(10.0);
  speeds(13);  // until 10.65, on the stop
  in_.plan = plan_from(10.5);
  const CommandStep late = step();
  EXPECT_EQ(late.reason, CommandReason::kTail);
  EXPECT_EQ(loop_.late_plans(), 1);
  speeds(10);
  // At rest it may begin late: the robot is where it was.
  ASSERT_EQ(loop_.state().command.linear.x(), 0.0);
  in_.plan = plan_from(in_.now - 0.1);
  EXPECT_EQ(step().reason, CommandReason::kPlan);
  EXPECT_EQ(loop_.late_plans(), 1);
}

TEST_F(CommandLoopTest, APlanThatTheGuardRefusesIsGivenUp) {
  in_.plan = plan_from(10.0);
  speeds(9);  // 0.36 m/s
  // A wall 0.15 m ahead of the body.
  test::ObstacleWorld world;
  const int wall =
      static_cast<int>(std::ceil(10.0 * (pose_.position.x() + CylinderShape{}.radius + 0.05)));
  for (int j = -10; j < 10; ++j) world.occupy_column(wall, j);
  world_ = world.belief();
  const CommandStep refused = step();
  EXPECT_EQ(refused.reason, CommandReason::kGuard);
  EXPECT_EQ(refused.guard, GuardReason::kMap);
  EXPECT_NEAR(refused.command.linear.x(), 0.32, 1e-9);
  EXPECT_FALSE(refused.detail.empty());
  world_ = test::ObstacleWorld().belief();
  EXPECT_EQ(step().reason, CommandReason::kNoPlan);
  EXPECT_FALSE(loop_.state().plan);
  in_.plan = plan_from(in_.now);
  EXPECT_EQ(step().reason, CommandReason::kPlan);
}

TEST_F(CommandLoopTest, AStaleBeliefStopsIt) {
  in_.plan = plan_from(10.0);
  speeds(5);
  in_.belief = [&] {
    Belief belief = world_;
    belief.set_stamps(in_.now);
    belief.stamps.pose = in_.now - 1.0;
    return std::make_shared<const Belief>(belief);
  }();
  const CommandStep step = loop_.step(in_);
  EXPECT_EQ(step.reason, CommandReason::kGuard);
  EXPECT_EQ(step.guard, GuardReason::kStale);
}

TEST_F(CommandLoopTest, APlanThatNobodyCertifiedIsNoPathToStopAlong) {
  in_.plan = plan_from(10.0);
  speeds(5);
  const auto unknown = plan_from(in_.now);
  unknown->certified = false;
  in_.plan = unknown;
  const CommandStep refused = step();
  EXPECT_EQ(refused.reason, CommandReason::kGuard);
  EXPECT_FALSE(follows_plan(refused.guard)) << to_string(refused.guard);
  EXPECT_TRUE(loop_.state().stop.empty());
}

TEST_F(CommandLoopTest, SaysWhatWillBeSent) {
  in_.plan = plan_from(10.0);
  speeds(4);  // until 10.15; the next at 10.2
  auto next = plan_from(10.3);
  next->commands = {twist(0.1), twist(0.1)};
  in_.plan = next;
  speeds(1);
  const CommandState state = loop_.state();
  ASSERT_TRUE(state.next);
  const std::vector<SentCommand> commands = commands_until(*model_, state, 10.21, 10.45, kPeriod);
  ASSERT_EQ(commands.size(), 5u + 4u);
  EXPECT_NEAR(commands[4].command.linear.x(), 0.2, 1e-9);
  EXPECT_NEAR(commands[5].time, 10.25, 1e-9);
  EXPECT_NEAR(commands[5].command.linear.x(), 0.24, 1e-9);
  EXPECT_NEAR(commands[6].time, 10.3, 1e-9);
  EXPECT_NEAR(commands[6].command.linear.x(), 0.2, 1e-9);
  // What it then sends is that.
  for (std::size_t k = 5; k < commands.size(); ++k) {
    EXPECT_NEAR(step().command.linear.x(), commands[k].command.linear.x(), 1e-9) << k;
  }
}

TEST_F(CommandLoopTest, WithADelayTheGuardLooksAtWhereTheCommandBeginsToAct) {
  CommandLoopOptions options;
  options.delay = {0.3, 0.3};
  CommandLoop delayed(model_, guard_, options);
  in_.plan = plan_from(10.0);
  test::ObstacleWorld world;
  for (int j = -10; j < 10; ++j) world.occupy_column(4, j);  // 0.22 m ahead of the body
  world_ = world.belief();
  // The pose that is measured stands still, as the base does for the time of the delay.
  bool refused = false;
  for (int k = 0; k < 10 && !refused; ++k) {
    Belief belief = world_;
    belief.set_stamps(in_.now);
    in_.belief = std::make_shared<const Belief>(belief);
    refused = delayed.step(in_).reason == CommandReason::kGuard;
    in_.now += kPeriod;
  }
  EXPECT_TRUE(refused);
}

TEST(CommandLoop, OptionsOutOfRangeAreRefused) {
  const auto model = std::make_shared<const Unicycle>();
  const Guard guard(model, CylinderShape{}, Certifier::Options());
  EXPECT_THROW(CommandLoop(nullptr, guard, {}), std::invalid_argument);
  CommandLoopOptions options;
  options.hold = 0.5 * options.period;
  EXPECT_THROW(CommandLoop(model, guard, options), std::invalid_argument);
}

// Given up where the plan turned, it braked straight on, off what had been certified.
TEST_F(CommandLoopTest, StopsAlongThePathOfThePlanThatIsGivenUp) {
  auto plan = plan_from(10.0);
  plan->commands = {twist(0.6, 0.9), twist(0.6, 0.9)};
  plan->inputs = {Eigen::Vector2d(0.6, 0.9), Eigen::Vector2d(0.6, 0.9)};
  plan->tail = {twist(0.4, 0.3), twist(0.2), twist(0.0)};
  plan->states = {Eigen::Vector3d::Zero()};
  in_.plan = plan;
  speeds(9);
  test::ObstacleWorld newest;
  for (int i = 3; i < 8; ++i) {
    for (int j = 2; j < 8; ++j) newest.occupy_column(i, j);
  }
  world_ = newest.belief();
  const CommandStep refused = step();
  EXPECT_EQ(refused.guard, GuardReason::kMap) << refused.detail;
  double v = refused.command.linear.x(), w = refused.command.yaw_rate;
  ASSERT_GT(v, 0.2);
  for (int k = 0; v > 0.05 && k < 30; ++k) {
    EXPECT_GT(w / v, 0.9) << k;
    const std::vector<Twist> foretold = loop_.state().stop;
    ASSERT_FALSE(foretold.empty());
    const CommandStep next = step();
    EXPECT_EQ(next.reason, CommandReason::kNoPlan);
    EXPECT_NEAR(next.command.linear.x(), v - 0.04, 1e-6);
    EXPECT_NEAR(next.command.yaw_rate, foretold.front().yaw_rate, 0.02);
    v = next.command.linear.x();
    w = next.command.yaw_rate;
  }
  EXPECT_LE(v, 0.05);
}

}  // namespace
}  // namespace prospect::command_loop_test
