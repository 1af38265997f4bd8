// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/step_specification.h"

#include <gtest/gtest.h>

#include "engine/planner/step_monitors.h"
#include "tests/engine/planning_scene.h"

namespace prospect::step_specification_test {
namespace {

/// A step of PlanningScene, with whatever a test changes.
struct Step {
  test::PlanningScene scene{"unicycle"};
  PlannerParameters parameters = scene.planner->parameters();
  FrontierPlanner frontiers{parameters.frontier_planner};
  SurfaceDrift drift;
  ModeKind mode = ModeKind::kExplore;
  SafetyLevel safety_level = SafetyLevel::kNormal;
  std::shared_ptr<const CostToGo> retreat;

  StepSpecification specify() {
    return specify_problem({scene.planner->robot(), parameters, scene.belief,
                            *scene.planner->global_plan(), frontiers, nullptr, mode, retreat,
                            safety_level, drift,
                            step_landmarks(scene.planner->robot(), parameters, scene.belief)});
  }
};

TEST(StepSpecification, MappedLandmarksComeBeforeExpectedOnes) {
  Step step;
  const StepSpecification made = step.specify();
  ASSERT_LE(made.num_mapped, made.problem.landmarks.size());
  EXPECT_GT(made.num_mapped, 0U);
  step.parameters.feature_prior = false;
  const StepSpecification without = step.specify();
  EXPECT_EQ(without.num_mapped, without.problem.landmarks.size());
}

TEST(StepSpecification, TheModeDecidesOnWeightsAndFeatures) {
  Step step;
  const ProblemSpecification explores = step.specify().problem;
  EXPECT_EQ(explores.weights.exploration_gain, step.parameters.weights.exploration_gain);
  step.mode = ModeKind::kRetreat;
  step.retreat = std::make_shared<const CostToGo>();
  const ProblemSpecification retreats = step.specify().problem;
  EXPECT_EQ(retreats.weights.exploration_gain, policy(ModeKind::kRetreat).exploration_weight *
                                                   step.parameters.weights.exploration_gain);
  EXPECT_EQ(retreats.features.criterion, VisibilityCriterion::kCount);
  EXPECT_GE(retreats.features.N_req, 2.0 * kEnoughToGoOn * step.parameters.features.N_min);
  EXPECT_EQ(retreats.cost_to_go, step.retreat);
  EXPECT_NE(explores.cost_to_go, step.retreat);
}

TEST(StepSpecification, FeaturesCostNothingWhereTheLocalizationDoesNotRestOnThem) {
  Step step;
  step.scene.belief.localization_source = LocalizationSource::kExternal;
  EXPECT_EQ(step.specify().problem.weights.visible_features, 0.0);
}

TEST(StepSpecification, TheSafetyLevelDecidesOnTheHardClearance) {
  Step step;
  EXPECT_EQ(step.specify().problem.clearance.d_safe, step.parameters.d_safe);
  step.safety_level = SafetyLevel::kReduced;
  EXPECT_EQ(step.specify().problem.clearance.d_safe, 0.0);
}

TEST(StepSpecification, TheTargetsFrontierAloneWhereThatIsAskedFor) {
  Step step;
  const std::size_t all = step.specify().problem.targets.targets.size();
  step.parameters.target_frontier_only = true;
  const std::size_t one = step.specify().problem.targets.targets.size();
  EXPECT_GT(one, 0U);
  EXPECT_LE(one, all);
  step.parameters.max_targets = 0;
  EXPECT_TRUE(step.specify().problem.targets.targets.empty());
}

}  // namespace
}  // namespace prospect::step_specification_test
