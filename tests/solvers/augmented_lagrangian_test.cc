// SPDX-License-Identifier: Apache-2.0
#include "solvers/augmented_lagrangian.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/solvers/problem_zoo.h"

namespace prospect::augmented_lagrangian_test {
namespace {

using zoo::Vector;

TEST(AugmentedLagrangian, HasTheGradientOfItsValue) {
  const zoo::Case c = zoo::hs43();
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  for (int i = 0; i < 100; ++i) {
    const Vector lambda = Vector::NullaryExpr(3, [&] { return std::abs(uniform(generator)); });
    const AugmentedLagrangian merit(3, lambda, 5.0, {0.0, 0.01});
    const Vector x = Vector::NullaryExpr(4, [&] { return uniform(generator); });
    Vector g = c.g(x);
    merit.add_gradient(c.c(x), c.J(x), g);
    for (int j = 0; j < 4; ++j) {
      const double h = 1e-6;
      Vector a = x, b = x;
      a[j] += h;
      b[j] -= h;
      const double difference =
          (merit.value(c.f(a), c.c(a)) - merit.value(c.f(b), c.c(b))) / (2 * h);
      EXPECT_NEAR(g[j], difference, 1e-5 * (1 + std::abs(difference)));
    }
  }
}

TEST(AugmentedLagrangian, IsASumOfSquares) {
  const zoo::Case c = zoo::hs43();
  std::mt19937_64 generator(12);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  for (int i = 0; i < 100; ++i) {
    const Vector lambda = Vector::NullaryExpr(3, [&] { return std::abs(uniform(generator)); });
    const AugmentedLagrangian merit(3, lambda, 5.0, {0.0, 0.01});
    const Vector x = Vector::NullaryExpr(4, [&] { return uniform(generator); });
    Vector r(3);
    ResidualJacobian J(3, 4);
    merit.residuals(c.c(x), r);
    merit.residual_jacobian(c.c(x), c.J(x), J);
    EXPECT_NEAR(0.5 * r.squaredNorm() - lambda.squaredNorm() / 10.0, merit.value(0.0, c.c(x)),
                1e-10);
    Vector gradient = Vector::Zero(4);
    merit.add_gradient(c.c(x), c.J(x), gradient);
    EXPECT_LE((J.transpose() * r - gradient).norm(), 1e-12 * (1.0 + gradient.norm()));
  }
}

TEST(AugmentedLagrangian, IsStationaryAtASolutionWithItsMultipliers) {
  const zoo::Case c = zoo::hs12();  // solution (2, 3), lambda = 1/2
  const AugmentedLagrangian merit(1, vec({0.5}), 10.0, {0.0, 0.0});
  const Vector x = vec({2, 3});
  Vector g = c.g(x);
  merit.add_gradient(c.c(x), c.J(x), g);
  EXPECT_NEAR(g.norm(), 0.0, 1e-12);
  EXPECT_NEAR(merit.value(c.f(x), c.c(x)), -30.0, 1e-12);
}

TEST(AugmentedLagrangian, UpdatesMultipliersAndPenalty) {
  AugmentedLagrangian merit(2, {}, 10.0, {0.0, 0.0});
  EXPECT_EQ(merit.lambda(), vec({0, 0}));
  EXPECT_DOUBLE_EQ(merit.update(vec({-0.2, 5.0})), 0.2);
  EXPECT_EQ(merit.lambda(), vec({2, 0}));
  EXPECT_EQ(merit.rho(), 10.0);
  EXPECT_DOUBLE_EQ(merit.update(vec({-0.05, 5.0})), 0.05);
  EXPECT_EQ(merit.rho(), 10.0);
  EXPECT_DOUBLE_EQ(merit.update(vec({-0.04, 5.0})), 0.04);  // fell by less than half
  EXPECT_EQ(merit.rho(), 100.0);
  // A multiplier that pulls although its constraint is slack counts as well.
  AugmentedLagrangian slack(1, vec({4}), 10.0, {0.0, 0.0});
  EXPECT_DOUBLE_EQ(slack.update(vec({3.0})), 0.4);
  EXPECT_EQ(slack.lambda(), vec({0}));
  // Multipliers of the wrong number or not finite are not used.
  EXPECT_EQ(AugmentedLagrangian(2, vec({1}), 1.0, {0.0, 0.0}).lambda(), vec({0, 0}));
  EXPECT_EQ(AugmentedLagrangian(1, vec({std::nan("")}), 1.0, {0.0, 0.0}).lambda(), vec({0}));
  EXPECT_EQ(AugmentedLagrangian(1, vec({-1}), 1.0, {0.0, 0.0}).lambda(), vec({0}));
}

// min (x - 1)^2, x <= 1/2: the least of L is in closed form, 1/2 the solution, 1 its multiplier.
TEST(AugmentedLagrangian, PointsOnTheWayAreFeasibleWithAMarginThatFalls) {
  static constexpr double kFinal = 1e-7;
  const auto rounds = [](double initial, int* first_feasible_at) {
    AugmentedLagrangian merit(1, {}, 10.0, {initial, kFinal});
    double margin = std::max(initial, kFinal);  // as the header has it fall
    for (int round = 1; round <= 40; ++round) {
      const double x =
          (2.0 + merit.rho() * (0.5 - margin) - merit.lambda()[0]) / (2.0 + merit.rho());
      const Vector c = vec({0.5 - x});
      Vector gradient = vec({2.0 * (x - 1.0)});
      merit.add_gradient(c, Eigen::MatrixXd::Constant(1, 1, -1.0), gradient);
      EXPECT_NEAR(gradient[0], 0.0, 1e-6) << "round " << round;
      if (c[0] >= 0.0 && *first_feasible_at == 0) *first_feasible_at = round;
      const double sigma = std::abs(c[0] - margin);  // the constraint is active
      const double off = merit.update(c);
      EXPECT_DOUBLE_EQ(off, std::max(sigma, margin - kFinal));
      if (off <= kFinal) {
        EXPECT_NEAR(x, 0.5, 2.0 * kFinal);
        EXPECT_GE(c[0], 0.0);
        EXPECT_NEAR(merit.lambda()[0], 1.0, 1e-5);
        return round;
      }
      margin = std::max(kFinal, std::min(0.5 * margin, sigma));
    }
    return 41;
  };
  int without = 0, with = 0;
  EXPECT_LE(rounds(0.0, &without), 40);
  EXPECT_LE(rounds(0.01, &with), 40);
  EXPECT_LE(with, 3);
  EXPECT_GE(without, with + 3);
}

// Two constraints that leave a band of 2e-6: no point keeps both by 0.01, ever.
TEST(AugmentedLagrangian, MarginFallsWhereNothingKeepsIt) {
  AugmentedLagrangian merit(2, {}, 10.0, {0.01, 1e-7});
  double off = 1.0;
  int rounds = 0;
  while (off > 2e-6 && rounds < 40) {
    off = merit.update(vec({1e-6, 1e-6}));
    ++rounds;
  }
  EXPECT_LE(rounds, 20);
}

}  // namespace
}  // namespace prospect::augmented_lagrangian_test
