// SPDX-License-Identifier: Apache-2.0
// Scores of planning problems: within their error, exact constraints, the same bits in any batch.

#include <gtest/gtest.h>

#include <random>

#include "tests/engine/planning_scene.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::score_test {
namespace {

TEST(Score, IsWithinItsErrorForEveryModelAndTheConstraintsAreExact) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  for (const char* model : {"unicycle", "unicycle_accel", "holonomic", "multirotor"}) {
    for (const double chance : {0.0, 0.3}) {
      PlannerParameters parameters;
      parameters.weights.heading_alignment = 0.1;
      parameters.w_c = chance;
      const test::PlanningScene scene(model, parameters, 250);
      const Problem& problem = *scene.problem;
      EXPECT_TRUE(problem.has_scores());
      std::mt19937_64 random(4);
      const Eigen::MatrixXd X = scene.points(100, random);
      Workspace workspace = problem.make_workspace();
      Evaluation value, score, one;
      ASSERT_TRUE(problem.evaluate(X, Evaluate::kValue, workspace, value)) << model;
      ASSERT_TRUE(problem.evaluate(X, Evaluate::kScore, workspace, score)) << model;
      EXPECT_TRUE((value.cost_error == 0.0).all());
      EXPECT_TRUE((score.cost_error > 0.0).all());
      // A third of the bound: it holds for what was not tried, too.
      EXPECT_TRUE(((score.cost - value.cost).abs() <= score.cost_error / 3.0).all()) << model;
      EXPECT_TRUE((score.cost != value.cost).any()) << model << ": nothing was scored";
      EXPECT_EQ(score.constraints, value.constraints) << model;
      for (int b = 0; b < 10; ++b) {
        problem.evaluate(X.col(b), Evaluate::kScore, workspace, one);
        EXPECT_EQ(one.cost[0], score.cost[b]) << model;
      }
    }
  }
}

TEST(Score, RejectsWhatAValueRejects) {
  const test::PlanningScene scene("unicycle", {}, 50);
  std::mt19937_64 random(5);
  Eigen::MatrixXd X = scene.points(3, random);
  X(0, 1) = 1e300;
  Workspace workspace = scene.problem->make_workspace();
  Evaluation value, score;
  EXPECT_FALSE(scene.problem->evaluate(X, Evaluate::kValue, workspace, value));
  EXPECT_FALSE(scene.problem->evaluate(X, Evaluate::kScore, workspace, score));
  EXPECT_TRUE((score.valid == value.valid).all());
  EXPECT_EQ(score.cost[1], Problem::kRejectedCost);
  EXPECT_EQ(score.cost_error[1], 0.0);
}

}  // namespace
}  // namespace prospect::score_test
