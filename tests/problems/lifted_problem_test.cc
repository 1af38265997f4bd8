// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/lifted_problem.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <memory>
#include <random>

#include "problems/path_problem.h"
#include "problems/r1.h"
#include "problems/zoo.h"

namespace prospect::lifted_problem_test {
namespace {

Eigen::MatrixXd dense(const LiftedProblem& lifted, const Eigen::VectorXd& nonzeros) {
  const ColumnPattern& pattern = lifted.pattern();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(pattern.height, pattern.width());
  for (int j = 0; j < pattern.width(); ++j) {
    for (int k = pattern.starts[static_cast<std::size_t>(j)];
         k < pattern.starts[static_cast<std::size_t>(j) + 1]; ++k) {
      J(pattern.rows[static_cast<std::size_t>(k)], j) = nonzeros[k];
    }
  }
  return J;
}

/// Eliminating the states gives cost, rows and derivatives of the problem itself.
void expect_condensed(const std::shared_ptr<const Problem>& problem, const Eigen::VectorXd& z) {
  const LiftedProblem lifted(problem);
  const int n = problem->num_variables(), m = problem->num_constraints();
  const int states = lifted.num_variables() - n;
  const Eigen::VectorXd w = lifted.lifted(z);
  LiftedProblem::Value value;
  ASSERT_TRUE(lifted.evaluate(w, value));
  Workspace workspace = problem->make_workspace();
  Evaluation e;
  ASSERT_TRUE(problem->evaluate(z, Evaluate::kGradient, workspace, e));
  EXPECT_EQ(value.constraints.head(states).lpNorm<Eigen::Infinity>(), 0.0);
  EXPECT_NEAR(value.cost, e.cost[0], 1e-12 * std::abs(e.cost[0]));
  EXPECT_LE((value.constraints.tail(m) - e.constraints.col(0)).norm(), 1e-12);
  const Eigen::MatrixXd J = dense(lifted, value.jacobian);
  const Eigen::MatrixXd by_z =
      -J.topRightCorner(states, states).partialPivLu().solve(J.topLeftCorner(states, n));
  const Eigen::VectorXd gradient =
      value.gradient.head(n) + by_z.transpose() * value.gradient.tail(states);
  EXPECT_LE((gradient - e.gradient).norm(), 1e-9 * std::max(1.0, e.gradient.norm()));
  const Eigen::MatrixXd rows = J.bottomLeftCorner(m, n) + J.bottomRightCorner(m, states) * by_z;
  EXPECT_LE((rows - e.jacobian).norm(), 1e-9 * std::max(1.0, e.jacobian.norm()));
}

TEST(LiftedProblem, IsTheProblemWhereTheStatesFollow) {
  const PathProblem path = path_problem(2);
  const auto problem = std::make_shared<const Problem>(path.problem);
  expect_condensed(problem, path.solution);
  expect_condensed(problem, Eigen::VectorXd::Constant(20, 0.2));
  expect_condensed(std::make_shared<const Problem>(make_r1()), r1_cold());
}

TEST(LiftedProblem, HasItsDerivativesWhereTheStatesDoNotFollow) {
  const PathProblem path = path_problem(1);
  const LiftedProblem lifted(std::make_shared<const Problem>(path.problem));
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> by(-0.2, 0.2);
  Eigen::VectorXd w = lifted.lifted(path.solution);
  for (double& value : w) value += by(generator);
  LiftedProblem::Value value, ahead, behind;
  ASSERT_TRUE(lifted.evaluate(w, value));
  EXPECT_GT(value.constraints.head(60).cwiseAbs().maxCoeff(), 0.05);
  const Eigen::MatrixXd J = dense(lifted, value.jacobian);
  for (int i = 0; i < w.size(); ++i) {
    Eigen::VectorXd moved = w;
    moved[i] += 1e-6;
    ASSERT_TRUE(lifted.evaluate(moved, ahead));
    moved[i] -= 2e-6;
    ASSERT_TRUE(lifted.evaluate(moved, behind));
    EXPECT_NEAR(value.gradient[i], (ahead.cost - behind.cost) / 2e-6, 1e-7);
    EXPECT_LE((J.col(i) - (ahead.constraints - behind.constraints) / 2e-6).norm(), 1e-7);
  }
}

TEST(LiftedProblem, IsSparse) {
  const PathProblem path = path_problem(1);
  const LiftedProblem lifted(std::make_shared<const Problem>(path.problem));
  EXPECT_EQ(lifted.num_variables(), 20 + 60);
  EXPECT_EQ(lifted.num_constraints(), 60 + 20);
  // Gaps: 2 inputs, the next state, 3 of the state but at the first stage; a row a node: 3.
  EXPECT_EQ(lifted.pattern().nonzeros(), 60 * 3 + 57 * 3 + 20 * 3);
  EXPECT_EQ(lifted.pattern().place(0, 79), -1);
  EXPECT_EQ(lifted.lower().head(20), path.problem.lower());
  EXPECT_EQ(lifted.upper()[20], std::numeric_limits<double>::infinity());
}

TEST(LiftedProblem, ThePatternOfAProblemIsItsJacobians) {
  const PathProblem path = path_problem(1);
  const ColumnPattern pattern = column_pattern(path.problem);
  EXPECT_EQ(pattern.width(), 20);
  EXPECT_EQ(pattern.height, 20);
  EXPECT_EQ(pattern.nonzeros(), path.problem.jacobian_pattern().count());
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 20; ++i) {
      EXPECT_EQ(pattern.place(i, j) >= 0, path.problem.jacobian_pattern()(i, j));
    }
  }
}

}  // namespace
}  // namespace prospect::lifted_problem_test
