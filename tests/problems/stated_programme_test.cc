// SPDX-License-Identifier: Apache-2.0
#include "problems/stated_programme.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "problems/expression_builder.h"
#include "problems/path_problem.h"
#include "problems/r1.h"
#include "problems/zoo.h"

namespace prospect::stated_programme_test {
namespace {

/// At a hundred points within the bounds cost, rows and derivatives are those of the problem.
void expect_same(const StatedProgramme& stated, const Problem& problem) {
  ASSERT_EQ(stated.lower, problem.lower());
  ASSERT_EQ(stated.upper, problem.upper());
  ASSERT_EQ(static_cast<int>(stated.rows.size()), problem.num_constraints());
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  Workspace workspace = problem.make_workspace();
  Evaluation e;
  const auto near = [](double a, double b, double size) {
    EXPECT_NEAR(a, b, 1e-9 * std::max(1.0, size));
  };
  for (int i = 0; i < 100 && !testing::Test::HasFailure(); ++i) {
    Eigen::VectorXd x = stated.lower;
    for (double& value : x) value = share(generator);
    x = stated.lower + x.cwiseProduct(stated.upper - stated.lower);
    ASSERT_TRUE(problem.evaluate(x, Evaluate::kGradient, workspace, e));
    near(stated.objective.value(x), e.cost[0], std::abs(e.cost[0]));
    const Eigen::VectorXd gradient = stated.objective.gradient(x);
    near((gradient - e.gradient).norm(), 0.0, e.gradient.norm());
    for (std::size_t r = 0; r < stated.rows.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      EXPECT_EQ(stated.rows[r].lower, 0.0);
      EXPECT_GT(stated.rows[r].upper, 1e300);
      near(stated.rows[r].body.value(x), e.constraints(row, 0), std::abs(e.constraints(row, 0)));
      const Eigen::VectorXd by_x = stated.rows[r].body.gradient(x);
      near((by_x - e.jacobian.row(row).transpose()).norm(), 0.0, by_x.norm());
    }
  }
}

TEST(StatedProgramme, OfTheZooIsTheZoo) {
  for (const auto& problems : {zoo::well_scaled(), zoo::badly_scaled()}) {
    for (const FunctionProblem& p : problems) {
      SCOPED_TRACE(p.name);
      expect_same(p.stated(), p.problem());
      EXPECT_EQ(p.stated().optimum, p.optimum);
    }
  }
  const PathProblem path = path_problem(2);
  expect_same(path.stated, path.problem);
}

TEST(StatedProgramme, OfR1IsR1) {
  for (const Eigen::Vector3d& x0 :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.3, -0.4, 2.9)}) {
    expect_same(r1_stated(x0), make_r1(x0));
  }
  EXPECT_NEAR(r1_stated().objective.value(r1_cold()), 404.3937943800, 1e-9);
}

TEST(StatedProgramme, AnExpressionHasWhatItNeedsAndNothingElse) {
  ExpressionBuilder e(3);
  const auto shared = e.x(0) * e.x(2);
  e.x(1);  // of no use
  const Expression made = e.finish(shared + shared * 2.0);
  EXPECT_EQ(made.nodes().size(), 6U);
  EXPECT_EQ(made.dependencies(), (std::vector<int>{0, 2}));
  const Eigen::Vector3d x(3.0, 5.0, 7.0);
  EXPECT_EQ(made.value(x), 63.0);
  EXPECT_EQ(made.gradient(x), Eigen::Vector3d(21.0, 0.0, 9.0));
  EXPECT_EQ(e.finish(e.sum({})).value(x), 0.0);
  EXPECT_EQ(e.finish(e.sum({e.x(0), e.x(1), e.x(2), e.x(2), e.x(0)})).value(x), 25.0);
}

TEST(StatedProgramme, OperationsHaveTheirDerivatives) {
  using Operation = Expression::Operation;
  for (int code = static_cast<int>(Operation::kNegate); code < Expression::kOperations; ++code) {
    const auto operation = static_cast<Operation>(code);
    SCOPED_TRACE(code);
    for (const Eigen::Vector3d& at :
         {Eigen::Vector3d(0.31, 0.72, 1.9), Eigen::Vector3d(0.64, 0.21, 0.4)}) {
      Eigen::Vector3d x = at;
      if (operation == Operation::kAcosh) x[0] += 1.5;
      const Expression f({{Operation::kVariable, 0},
                          {Operation::kVariable, 1},
                          {Operation::kVariable, 2},
                          {operation, 0, 1, 2}},
                         3);
      const Eigen::VectorXd gradient = f.gradient(x);
      for (int i = 0; i < 3; ++i) {
        Eigen::Vector3d ahead = x, behind = x;
        ahead[i] += 1e-6;
        behind[i] -= 1e-6;
        EXPECT_NEAR(gradient[i], (f.value(ahead) - f.value(behind)) / 2e-6, 1e-8);
      }
    }
  }
}

TEST(StatedProgramme, TheSideThatDoesNotCountHasNoDerivative) {
  using enum Expression::Operation;
  ExpressionBuilder e(1);
  const auto root = e.of(kSqrt, e.x(0));
  const Expression f = e.finish(e.choose(e.x(0) < 0.0, e.number(0.0) - e.x(0), root));
  EXPECT_EQ(f.value(Eigen::VectorXd::Constant(1, -4.0)), 4.0);
  EXPECT_EQ(f.gradient(Eigen::VectorXd::Constant(1, -4.0))[0], -1.0);
  EXPECT_EQ(f.gradient(Eigen::VectorXd::Constant(1, 4.0))[0], 0.25);
}

TEST(StatedProgramme, OperationsComeAfterTheirOperands) {
  using Operation = Expression::Operation;
  EXPECT_THROW(Expression(std::vector<Expression::Node>(), 1), std::invalid_argument);
  EXPECT_THROW(Expression({{Operation::kNegate, 0}}, 1), std::invalid_argument);
  EXPECT_THROW(Expression({{Operation::kVariable, 1}}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::stated_programme_test
