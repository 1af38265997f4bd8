#include "adapters/run/run_recorder.h"

#include <gtest/gtest.h>

#include <memory>

#include "adapters/config/configuration.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/belief.h"
#include "engine/safety/plan.h"

namespace prospect::run_recorder_test {
namespace {

TEST(RunRecorder, OfALongRunOnlySomeStepsHoldMemoryForTheirPlans) {
  const Configuration configuration = read_configuration("");
  const ExplorationRunOptions options;
  RunRecorder recorder(configuration, options, nullptr);
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
    recorder.add(step, {});
  }
  const RunRecord record = recorder.finish({}, "a world", {}, nullptr);
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

}  // namespace
}  // namespace prospect::run_recorder_test
