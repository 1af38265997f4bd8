// SPDX-License-Identifier: Apache-2.0
#include "runtime/next_command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "models/make_model.h"

namespace prospect::next_command_test {
namespace {

constexpr double kStep = 0.05;

Twist twist(double v, double w = 0.0) { return {{v, 0.0, 0.0}, w}; }

/// A stage of 0.5 m/s and 0.3 rad/s, one of 0.4 m/s, then the stop.
Plan plan_from_10() {
  Plan plan;
  plan.kind = PlanKind::kOptimised;
  plan.stamp = 10.0;
  plan.commands = {twist(0.5, 0.3), twist(0.4)};
  plan.committed = 2;
  plan.tail = {twist(0.2), twist(0.0)};
  plan.certified = true;
  return plan;
}

// The unicycle takes 0.8 m/s^2 and 2.5 rad/s^2: 0.04 m/s and 0.125 rad/s in a step.

TEST(NextCommand, RampsTowardsThePlanWithinTheRates) {
  const auto model = make_model("unicycle");
  const NextCommand next =
      next_command(*model, plan_from_10(), 1.0, {}, twist(0.3, 0.0), 10.0, kStep);
  EXPECT_NEAR(next.command.linear.x(), 0.34, 1e-12);
  EXPECT_NEAR(next.command.yaw_rate, 0.125, 1e-12);
  EXPECT_NEAR(next.input[0], 0.34, 1e-12);
  EXPECT_NEAR(next_command(*model, plan_from_10(), 1.0, {}, twist(0.48, 0.3), 10.1, kStep)
                  .command.linear.x(),
              0.5, 1e-9);
}

TEST(NextCommand, OfAShareOfThePlansVelocities) {
  const auto model = make_model("unicycle");
  const NextCommand next =
      next_command(*model, plan_from_10(), 0.5, {}, twist(0.26, 0.14), 10.0, kStep);
  EXPECT_NEAR(next.command.linear.x(), 0.25, 1e-9);
  EXPECT_NEAR(next.command.yaw_rate, 0.15, 1e-9);
}

TEST(NextCommand, BrakesPastTheCommittedPartBeforeThePlanAndInAStoppingTail) {
  const auto model = make_model("unicycle");
  Plan plan = plan_from_10();
  for (const double now : {9.9, 10.5, 10.8, 50.0}) {
    const Twist command = next_command(*model, plan, 1.0, {}, twist(0.4, 0.1), now, kStep).command;
    EXPECT_NEAR(command.linear.x(), 0.36, 1e-12) << now;
    EXPECT_NEAR(command.yaw_rate, 0.0, 1e-12) << now;
  }
  plan.kind = PlanKind::kStoppingTail;
  EXPECT_NEAR(next_command(*model, plan, 1.0, {}, twist(0.4), 10.1, kStep).command.linear.x(), 0.36,
              1e-12);
}

TEST(NextCommand, WithAccelerationsItFollowsTheRampOfThePlan) {
  const auto model = make_model("unicycle_accel");
  Plan plan = plan_from_10();
  plan.ramp_from = twist(0.4, 0.2);
  const NextCommand next = next_command(*model, plan, 1.0, {}, twist(0.4, 0.2), 10.0, kStep);
  EXPECT_NEAR(next.command.linear.x(), 0.42, 1e-9);
  EXPECT_NEAR(next.command.yaw_rate, 0.22, 1e-9);
  EXPECT_NEAR(next.input[0], 0.4, 1e-6);
}

TEST(BrakingCommand, EndsAtRestAndNeverIsNotFinite) {
  const double nan = std::nan("");
  for (const char* name : {"unicycle", "unicycle_accel", "holonomic", "multirotor"}) {
    const auto model = make_model(name);
    Twist command = twist(0.5, -0.7);
    for (int n = 0; n < 100; ++n) command = braking_command(*model, {}, command, kStep).command;
    EXPECT_NEAR(command.linear.norm(), 0.0, 1e-9) << name;
    EXPECT_NEAR(command.yaw_rate, 0.0, 1e-9) << name;
    // Braking does not depend on where the robot is.
    for (const Pose& nowhere :
         {Pose{{nan, 0.0, 0.0}, nan}, Pose{{nan, 0.0, 0.0}, 0.0}, Pose{{}, nan}}) {
      EXPECT_EQ(braking_command(*model, nowhere, twist(0.5), kStep).command.linear,
                braking_command(*model, {}, twist(0.5), kStep).command.linear);
    }
    EXPECT_EQ(braking_command(*model, {}, twist(nan), kStep).command.linear.norm(), 0.0);
  }
}

TEST(CommandsToCome, FollowThePlanByTimeAndThenItsStop) {
  const auto model = make_model("unicycle");
  const Plan plan = plan_from_10();
  const std::vector<SentCommand> sent =
      commands_to_come(*model, &plan, 1.0, twist(0.5, 0.3), 10.1, 10.7, kStep);
  ASSERT_EQ(sent.size(), 12u);
  EXPECT_DOUBLE_EQ(sent[2].time, 10.2);
  EXPECT_NEAR(sent[1].command.linear.x(), 0.5, 1e-9);
  EXPECT_NEAR(sent[5].command.linear.x(), 0.4, 1e-9);  // 10.35
  EXPECT_NEAR(sent[11].command.linear.x(), 0.4 - 4 * 0.04, 1e-9);
  EXPECT_TRUE(commands_to_come(*model, &plan, 1.0, {}, 10.4, 10.4, kStep).empty());
  EXPECT_TRUE(commands_to_come(*model, &plan, 1.0, {}, 10.0, 11.0, 0.0).empty());
}

TEST(CommandsToCome, WithoutAPlanTheyBrake) {
  const auto model = make_model("unicycle");
  const std::vector<SentCommand> sent =
      commands_to_come(*model, nullptr, 1.0, twist(0.1), 10.0, 10.2, kStep);
  ASSERT_EQ(sent.size(), 4u);
  EXPECT_NEAR(sent[0].command.linear.x(), 0.06, 1e-12);
  EXPECT_NEAR(sent[3].command.linear.x(), 0.0, 1e-12);
}

}  // namespace
}  // namespace prospect::next_command_test
