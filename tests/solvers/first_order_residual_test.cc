// SPDX-License-Identifier: Apache-2.0
#include "solvers/first_order_residual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "problems/zoo.h"

namespace prospect::first_order_residual_test {
namespace {

constexpr double kFeasible = 1e-6;

TEST(FirstOrderResidual, IsTheScaledGradientInside) {
  FunctionProblem p;
  p.lower = vec({0.0, -1.0});
  p.upper = vec({1e5, 1.0});
  p.start = vec({0.0, 0.0});
  p.f = [](const Eigen::VectorXd& u) { return 3e-5 * u[0] - 2.0 * u[1]; };
  p.g = [](const Eigen::VectorXd&) { return vec({3e-5, -2.0}); };
  const Problem problem = p.problem();
  // By shares of the widths the gradient is (3, -4). The cost is below 1.
  EXPECT_NEAR(first_order_residual(problem, vec({1e4, 0.2}), kFeasible), 4.0, 1e-12);
  // At the upper bound of the second variable the first alone is left.
  EXPECT_NEAR(first_order_residual(problem, vec({8e4, 1.0}), kFeasible), 3.0, 1e-12);
  // Within a millionth of the width is at the bound, and both bounds hold it.
  EXPECT_EQ(first_order_residual(problem, vec({0.09, 1.0 - 1e-7}), kFeasible), 0.0);
}

TEST(FirstOrderResidual, IsRelativeToTheCostAboveOne) {
  FunctionProblem p;
  p.lower = vec({0.0});
  p.upper = vec({2.0});
  p.start = vec({1.0});
  p.f = [](const Eigen::VectorXd& u) { return 100.0 * u[0]; };
  p.g = [](const Eigen::VectorXd&) { return vec({100.0}); };
  EXPECT_NEAR(first_order_residual(p.problem(), vec({1.0}), kFeasible), 2.0, 1e-12);
}

TEST(FirstOrderResidual, VanishesAtConstrainedOptima) {
  // Of HS35 and HS43 the minimisers are known exactly; constraints are active at both.
  EXPECT_LT(
      first_order_residual(zoo::hs35().problem(), vec({4.0 / 3, 7.0 / 9, 4.0 / 9}), kFeasible),
      1e-12);
  EXPECT_LT(first_order_residual(zoo::hs43().problem(), vec({0.0, 1.0, 2.0, -1.0}), kFeasible),
            1e-12);
  EXPECT_GT(first_order_residual(zoo::hs43().problem(), vec({0.0, 1.0, 1.9, -1.0}), kFeasible),
            1e-2);
}

TEST(FirstOrderResidual, IsInfiniteWhereAConstraintIsViolated) {
  EXPECT_TRUE(
      std::isinf(first_order_residual(zoo::hs35().problem(), vec({3.0, 3.0, 3.0}), kFeasible)));
}

TEST(FirstOrderResidual, IsUnknownWithoutAGradientAndForAPointOfAnotherSize) {
  FunctionProblem p = zoo::rosenbrock();
  EXPECT_TRUE(std::isnan(first_order_residual(p.problem(), vec({1.0}), kFeasible)));
  p.g = {};
  EXPECT_TRUE(std::isnan(first_order_residual(p.problem(), vec({1.0, 1.0}), kFeasible)));
}

TEST(FirstOrderResidual, SeesAFalseOptimumOfUnitsFarApart) {
  for (const FunctionProblem& p : zoo::badly_scaled()) {
    EXPECT_GT(first_order_residual(p.problem(), p.start, kFeasible), 0.1) << p.name;
  }
}

}  // namespace
}  // namespace prospect::first_order_residual_test
