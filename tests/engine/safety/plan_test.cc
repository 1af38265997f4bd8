// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace prospect::plan_test {
namespace {

Twist forward(double speed, double yaw_rate = 0.0) { return {{speed, 0.0, 0.0}, yaw_rate}; }

/// Two stages are committed, a third is only foreseen, the stop takes two more.
Plan plan_from_10() {
  Plan plan;
  plan.kind = PlanKind::kOptimised;
  plan.stamp = 10.0;
  plan.dt = 0.25;
  plan.commands = {forward(0.2, 0.1), forward(0.4, 0.2), forward(0.6)};
  plan.committed = 2;
  plan.tail = {forward(0.2), forward(0.0)};
  plan.certified = true;
  return plan;
}

TEST(Plan, IsSampledByTime) {
  const Plan plan = plan_from_10();
  struct Case {
    double t;
    PlanPhase phase;
    double speed, yaw_rate;
  };
  const double kInfinity = std::numeric_limits<double>::infinity();
  for (const Case& c :
       {Case{9.99, PlanPhase::kBefore, 0.0, 0.0}, Case{10.0, PlanPhase::kCommitted, 0.2, 0.1},
        Case{10.24, PlanPhase::kCommitted, 0.2, 0.1}, Case{10.25, PlanPhase::kCommitted, 0.4, 0.2},
        Case{10.49, PlanPhase::kCommitted, 0.4, 0.2}, Case{10.5, PlanPhase::kTail, 0.2, 0.0},
        Case{10.75, PlanPhase::kTail, 0.0, 0.0}, Case{11.0, PlanPhase::kRest, 0.0, 0.0},
        Case{1e9, PlanPhase::kRest, 0.0, 0.0}, Case{kInfinity, PlanPhase::kRest, 0.0, 0.0},
        Case{std::nan(""), PlanPhase::kRest, 0.0, 0.0}}) {
    EXPECT_EQ(plan.phase_at(c.t), c.phase) << c.t;
    EXPECT_EQ(plan.command_at(c.t).linear.x(), c.speed) << c.t;
    EXPECT_EQ(plan.command_at(c.t).yaw_rate, c.yaw_rate) << c.t;
  }
}

TEST(Plan, StagesBeginWhereSumsOfTheirLengthsSay) {
  Plan plan = plan_from_10();
  plan.stamp = 1234.1;
  plan.dt = 0.1;
  double t = plan.stamp;
  for (const double speed : {0.2, 0.4, 0.2, 0.0}) {
    EXPECT_EQ(plan.command_at(t).linear.x(), speed);
    t += 0.1;
  }
}

TEST(Plan, WithAccelerationsTheVelocityChangesLinearly) {
  Plan plan = plan_from_10();
  plan.ramp_from = forward(0.0);
  EXPECT_NEAR(plan.command_at(10.0).linear.x(), 0.0, 1e-12);
  EXPECT_NEAR(plan.command_at(10.125).linear.x(), 0.1, 1e-12);
  EXPECT_NEAR(plan.command_at(10.375).linear.x(), 0.3, 1e-12);
  EXPECT_NEAR(plan.command_at(10.375).yaw_rate, 0.15, 1e-12);
  EXPECT_NEAR(plan.command_at(10.625).linear.x(), 0.3, 1e-12);
  EXPECT_NEAR(plan.command_at(10.875).linear.x(), 0.1, 1e-12);
  EXPECT_EQ(plan.command_at(11.0).linear.x(), 0.0);
}

TEST(Plan, AStoppingTailStopsAndRests) {
  Plan plan = plan_from_10();
  plan.kind = PlanKind::kStoppingTail;
  plan.commands = {forward(0.2), forward(0.0)};
  plan.tail.clear();
  plan.certified = false;
  EXPECT_EQ(plan.command_at(10.1).linear.x(), 0.2);
  EXPECT_EQ(plan.command_at(10.3).linear.x(), 0.0);
  EXPECT_EQ(plan.phase_at(10.6), PlanPhase::kRest);
}

TEST(Plan, WhatCannotBeSampledRests) {
  Plan plan;
  EXPECT_EQ(plan.phase_at(0.0), PlanPhase::kRest);
  EXPECT_EQ(plan.command_at(0.0).linear.norm(), 0.0);
  for (const double dt : {0.0, -1.0, std::nan("")}) {
    plan = plan_from_10();
    plan.dt = dt;
    EXPECT_EQ(plan.command_at(10.1).linear.norm(), 0.0) << dt;
  }
  plan = plan_from_10();
  plan.committed = 9;  // more than there are
  EXPECT_EQ(plan.command_at(10.6).linear.x(), 0.6);
  EXPECT_EQ(plan.command_at(10.8).linear.x(), 0.2);
  plan.committed = -1;
  EXPECT_EQ(plan.phase_at(10.1), PlanPhase::kTail);
}

}  // namespace
}  // namespace prospect::plan_test
