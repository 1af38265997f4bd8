// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/global_planner.h"

#include <gtest/gtest.h>

#include "tests/engine/planning_scene.h"

namespace prospect::global_planner_test {
namespace {

struct Robot {
  test::PlanningScene scene{"unicycle"};
  PlannerParameters parameters = scene.planner->parameters();
  GlobalPlanner planner{scene.planner->robot(), parameters};
  WorkerThreads workers{1};
  WholeMap whole;

  std::shared_ptr<const GlobalPlan> step() {
    whole = planner.update(scene.belief, parameters, scene.belief.stamp, {}, nullptr, workers);
    return whole.global_plan;
  }
};

TEST(GlobalPlanner, LeadsToWhatTheTaskSays) {
  Robot r;
  EXPECT_TRUE(r.step()->target.has_value());
  EXPECT_TRUE(r.whole.frontiers.has_value());
  EXPECT_FALSE(r.planner.goal().has_value());

  r.parameters.task.kind = TaskKind::kGoTo;
  r.parameters.task.goal.position = {0.6, 0.4};
  r.planner.restart_task(r.parameters.task);
  r.step();
  EXPECT_TRUE(r.whole.goal.has_value());
  EXPECT_FALSE(r.whole.frontiers.has_value());
  ASSERT_TRUE(r.planner.goal().has_value());
  EXPECT_EQ(r.planner.goal()->position, Eigen::Vector2d(0.6, 0.4));

  r.parameters.task.kind = TaskKind::kHold;
  r.planner.restart_task(r.parameters.task);
  const auto stays = r.step();
  EXPECT_FALSE(stays->target.has_value());
  EXPECT_NE(stays->cost_to_go, nullptr);
  EXPECT_FALSE(r.planner.goal().has_value());
}

TEST(GlobalPlanner, ReturnsToWhereItWasFirst) {
  Robot r;
  r.step();
  const Pose first = r.scene.belief.pose;
  r.scene.belief.pose.position.x() += 0.5;
  r.scene.belief.stamp = 1.0;
  r.parameters.task.kind = TaskKind::kReturn;
  r.planner.restart_task(r.parameters.task);
  r.step();
  ASSERT_TRUE(r.planner.goal().has_value());
  EXPECT_EQ(r.planner.goal()->position, first.position.head<2>());
  EXPECT_EQ(r.planner.goal()->yaw, first.yaw);
}

}  // namespace
}  // namespace prospect::global_planner_test
