// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/stopping_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "models/make_model.h"

namespace prospect::stopping_plan_test {
namespace {

TEST(StoppingPlan, BrakesFromTheCommandInForceWhateverTheBeliefHolds) {
  for (const std::string& name : model_names()) {
    SCOPED_TRACE(name);
    const auto model = make_model(name);
    Belief belief;
    belief.stamp = 3.0;
    belief.pose.position.x() = std::numeric_limits<double>::quiet_NaN();
    belief.twist.linear.x() = 1e300;
    Twist command;
    command.linear.x() = 0.3;
    belief.command = command;
    Mode mode;
    mode.kind = ModeKind::kRetreat;
    const Plan plan = stopping_plan(belief, *model, 0.25,
                                    {TaskKind::kGoTo, mode, SafetyLevel::kStuck}, "a reason");
    EXPECT_EQ(plan.kind, PlanKind::kStoppingTail);
    EXPECT_FALSE(plan.certified);
    EXPECT_EQ(plan.stamp, 3.0);
    EXPECT_EQ(plan.task, TaskKind::kGoTo);
    EXPECT_EQ(plan.mode.kind, ModeKind::kRetreat);
    EXPECT_EQ(plan.safety_level, SafetyLevel::kStuck);
    EXPECT_EQ(plan.detail, "a reason");
    EXPECT_EQ(plan.why, "Brakes: a reason.");
    ASSERT_EQ(plan.states.size(), plan.commands.size() + 1);
    EXPECT_EQ(plan.committed, static_cast<int>(plan.commands.size()));
    double before = 0.3;
    for (const Twist& c : plan.commands) {
      EXPECT_TRUE(c.linear.allFinite() && std::isfinite(c.yaw_rate));
      EXPECT_LE(c.linear.norm(), before + 1e-12);
      before = c.linear.norm();
    }
    EXPECT_LE(before, 1e-3);
  }
}

}  // namespace
}  // namespace prospect::stopping_plan_test
