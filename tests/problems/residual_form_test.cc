// SPDX-License-Identifier: Apache-2.0
// The residuals that the problems state are their costs, and their Jacobian is that of differences.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "problems/path_problem.h"
#include "problems/r1.h"
#include "problems/zoo.h"

namespace prospect::residual_form_test {
namespace {

void expect_sum_of_squares(const std::string& name, const Problem& problem) {
  SCOPED_TRACE(name);
  ASSERT_EQ(problem.terms_without_residuals(), "");
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0.05, 0.95);
  Workspace workspace = problem.make_workspace();
  Evaluation e, low, high;
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::VectorXd z(problem.num_variables());
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      z[i] = problem.lower()[i] + unit(random) * (problem.upper()[i] - problem.lower()[i]);
    }
    ASSERT_TRUE(problem.evaluate(z, Evaluate::kResiduals, workspace, e));
    const double scale = 1.0 + std::abs(e.residual_offset) + std::abs(e.cost[0]);
    EXPECT_NEAR(e.residual_offset + 0.5 * e.residuals.squaredNorm(), e.cost[0], 1e-11 * scale);
    constexpr double kStep = 1e-6;
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      const Eigen::VectorXd step = Eigen::VectorXd::Unit(z.size(), i) * kStep;
      ASSERT_TRUE(problem.evaluate(z - step, Evaluate::kResiduals, workspace, low));
      ASSERT_TRUE(problem.evaluate(z + step, Evaluate::kResiduals, workspace, high));
      const Eigen::VectorXd slope = (high.residuals - low.residuals) / (2.0 * kStep);
      for (Eigen::Index r = 0; r < slope.size(); ++r) {
        ASSERT_NEAR(e.residual_jacobian(r, i), slope[r], 1e-5 * std::max(1.0, std::abs(slope[r])))
            << "row " << r << ", variable " << i;
      }
    }
  }
}

TEST(ResidualForm, OfTheZooIsItsCost) {
  for (const auto& problems : {zoo::well_scaled(), zoo::badly_scaled()}) {
    for (const FunctionProblem& p : problems) expect_sum_of_squares(p.name, p.problem());
  }
}

TEST(ResidualForm, OfThePathProblemIsItsCost) {
  expect_sum_of_squares("path", path_problem().problem);
}

TEST(ResidualForm, OfR1IsItsCost) {
  for (const Eigen::Vector3d& x0 : r1_starts(17, 3)) expect_sum_of_squares("R1", make_r1(x0));
}

}  // namespace
}  // namespace prospect::residual_form_test
