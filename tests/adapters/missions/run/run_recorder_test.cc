// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/run_recorder.h"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/belief.h"
#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "engine/safety/plan.h"
#include "solvers/registry.h"

namespace prospect::run_recorder_test {
namespace {

TEST(RunRecorder, OfALongRunOnlySomeStepsHoldMemoryForTheirPlans) {
  const Configuration configuration = read_configuration("");
  RunRecorder recorder(configuration);
  Belief belief;
  belief.ground = std::make_shared<const GroundMap>(GridFrame{0.1, 0, 0, 10, 10});
  GlobalPlan global_plan;
  global_plan.cost_to_go = std::make_shared<const CostToGo>();
  global_plan.frontiers.resize(2);
  for (Frontier& frontier : global_plan.frontiers) frontier.cells.resize(10);
  global_plan.frontiers[1].active = true;
  Plan plan;
  plan.states.resize(20, Eigen::VectorXd::Zero(configuration.robot.model->nx()));
  plan.candidates.resize(3);
  const int steps = 4001;
  for (int k = 0; k < steps; ++k) {
    MissionStep step;
    step.index = k;
    step.belief = &belief;
    step.plan = &plan;
    step.global_plan = &global_plan;
    recorder.on_step(step);
  }
  const RunRecord record = recorder.finish({}, "a world", nullptr, nullptr);
  ASSERT_EQ(record.steps.size(), steps);
  for (const StepRecord& step : record.steps) {
    const bool kept = step.step % 2 == 0;
    ASSERT_EQ(step.active_frontiers, 1);
    ASSERT_EQ(step.frontier_cells.size(), kept ? 10 : 0);
    ASSERT_EQ(step.horizon.size(), kept ? 20 : 0);
    ASSERT_EQ(step.candidates.size(), kept ? 3 : 0);
    if (!kept) {
      ASSERT_EQ(step.frontier_cells.capacity(), 0) << step.step;
      ASSERT_EQ(step.horizon.capacity(), 0) << step.step;
      ASSERT_EQ(step.candidates.capacity(), 0) << step.step;
    }
  }
}

TEST(RunRecorder, FrontiersAreTheTargetThreeAfterItAndWhyNotTheOthers) {
  using Why = FrontierStanding::Why;
  const Configuration configuration = read_configuration("");
  Belief belief;
  belief.ground = std::make_shared<const GroundMap>(GridFrame{0.1, 0, 0, 10, 10});
  GlobalPlan global_plan;
  global_plan.cost_to_go = std::make_shared<const CostToGo>();
  global_plan.frontiers.resize(9);
  global_plan.frontiers[2].centroid = {1.5, -2.0};
  const Plan plan;
  const auto said = [&](std::vector<FrontierStanding> standings) {
    global_plan.standings = std::move(standings);
    RunRecorder recorder(configuration);
    MissionStep step;
    step.belief = &belief;
    step.plan = &plan;
    step.global_plan = &global_plan;
    recorder.on_step(step);
    return recorder.finish({}, "a world", nullptr, nullptr).steps.at(0).frontiers;
  };
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({{2, Why::kInOrder, 3.2, 8.44}}), "3.20 m2 in 8.4 s at 1.50 -2.00");
  EXPECT_EQ(
      said({{0, Why::kLittle, 0.01, 3.0}, {1, Why::kNoPath, 0.0}, {2, Why::kLittle, 0.0, 1.0}}),
      "2 little; 1 no path");
  EXPECT_EQ(said({{2, Why::kInOrder, 3.0, 8.0},
                  {3, Why::kInOrder, 2.0, 9.0},
                  {4, Why::kInOrder, 1.0, 10.0},
                  {5, Why::kInOrder, 0.5, 11.0},
                  {6, Why::kInOrder, 0.4, 12.0},
                  {7, Why::kLater, 0.3, 13.0},
                  {8, Why::kLowYield, 0.2, 50.0}}),
            "3.00 m2 in 8.0 s at 1.50 -2.00; 2.00 m2 in 9.0 s at 0.00 0.00; 1.00 m2 in 10.0 s at "
            "0.00 0.00; 0.50 m2 in 11.0 s at 0.00 0.00; 1 later; 1 low yield");
}

// A term of a user may have any name.
TEST(RunRecorder, TheClearanceIsThatOfTheTermThatMeasuresIt) {
  Configuration configuration = read_configuration("");
  configuration.planner.d_safe = 0.0625;
  RunRecorder recorder(configuration);
  Belief belief;
  belief.ground = std::make_shared<const GroundMap>(GridFrame{0.1, 0, 0, 10, 10});
  Plan plan;
  plan.explanation.terms = {{"to walls", "m", 0.25, 0.0, true, TermQuantity::kClearance},
                            {"clearance", "m", 7.0, 7.0, false}};
  MissionStep step;
  step.belief = &belief;
  step.plan = &plan;
  recorder.on_step(step);
  EXPECT_EQ(recorder.finish({}, "a world", nullptr, nullptr).steps[0].clearance, 0.3125);
}

// At its end, after it has chosen landmarks and candidates.
TEST(RunRecorder, AStepThatFailsOnTheWayIsRecordedAsOneThatMadeNothing) {
  const Configuration configuration = read_configuration("");
  Planner planner(configuration.robot, configuration.planner, SolverRegistry().make("nlopt"));
  planner.set_cancelled([]() -> bool { throw std::runtime_error("out of order"); });
  RunRecorder recorder(configuration);
  Belief belief;
  const GridFrame frame{0.1, -20, -20, 40, 40};
  VoxelGrid voxels(frame, 0.0, 0.6);
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    for (int k = 0; k < voxels.depth(); ++k) voxels.set(c.i, c.j, k, CellState::kFree);
  }
  belief.ground = std::make_shared<const GroundMap>(project(voxels, {0.1, 0.5}));
  belief.voxels = std::make_shared<const VoxelGrid>(voxels);
  belief.octree = std::make_shared<const octomap::OcTree>(0.1);
  LandmarkMap landmarks;
  landmarks.landmarks.resize(80);
  for (Landmark& landmark : landmarks.landmarks) landmark.position = {1.5, 0.0, 0.4};
  belief.landmarks = std::make_shared<const LandmarkMap>(landmarks);
  const Plan plan = planner.plan(belief);
  EXPECT_EQ(plan.fault, PlanFault::kError);
  MissionStep step;
  step.belief = &belief;
  step.plan = &plan;
  const std::shared_ptr<const GlobalPlan> global_plan = planner.global_plan();
  step.global_plan = global_plan.get();
  step.made = planner.step();
  recorder.on_step(step);
  const RunRecord record = recorder.finish({}, "a world", nullptr, nullptr);
  ASSERT_EQ(record.steps.size(), 1U);
  EXPECT_TRUE(record.steps[0].landmarks.empty());
  EXPECT_TRUE(record.steps[0].candidates.empty());
  EXPECT_EQ(record.steps[0].certificate, plan.detail);
}

}  // namespace
}  // namespace prospect::run_recorder_test
