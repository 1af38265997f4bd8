// SPDX-License-Identifier: Apache-2.0
#include "solvers/sqp/quadratic_program.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace prospect::quadratic_program_test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Status = QuadraticProgram::Status;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Programme {
  Matrix G;
  Vector g;
  Matrix A;
  Vector b, lower, upper;
  Vector inside;  ///< a feasible point
};

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double normal() { return normal_(generator_); }
  int below(int end) { return static_cast<int>(generator_() % static_cast<unsigned>(end)); }
  Matrix matrix(int rows, int columns) {
    return Matrix::NullaryExpr(rows, columns, [&] { return normal(); });
  }
  /// A programme with a feasible point: each row of A is active at it or not.
  Programme programme(int n, int m) {
    const Matrix M = matrix(n, n);
    Programme p{M * M.transpose() + 0.01 * Matrix::Identity(n, n),
                3.0 * matrix(n, 1),
                matrix(m, n),
                Vector(m),
                Vector::Constant(n, -1.0),
                Vector::Constant(n, 1.0),
                matrix(n, 1).cwiseMax(-1.0).cwiseMin(1.0)};
    p.b = -p.A * p.inside;
    for (double& b : p.b) b += below(3) == 0 ? 0.0 : std::abs(normal());
    return p;
  }

 private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
};

Status solve(QuadraticProgram& solver, const Programme& p) {
  return solver.solve(p.G, p.g, p.A, p.b, p.lower, p.upper);
}

/// The conditions of Karush, Kuhn and Tucker, which are sufficient: the largest violation.
double error(const QuadraticProgram& solver, const Programme& p) {
  const Vector& x = solver.x();
  const Vector stationary = p.G * x + p.g - p.A.transpose() * solver.multipliers() -
                            solver.lower_multipliers() + solver.upper_multipliers();
  const Vector c = p.A * x + p.b;
  const double scale = 1.0 + p.g.norm() + solver.multipliers().sum();
  double worst = stationary.lpNorm<Eigen::Infinity>() / scale;
  const auto complementary = [&](double value, double multiplier) {
    worst = std::max({worst, -value, -multiplier, multiplier > 0.0 ? value : 0.0});
  };
  for (Eigen::Index r = 0; r < c.size(); ++r) complementary(c[r], solver.multipliers()[r]);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    complementary(x[i] - p.lower[i], solver.lower_multipliers()[i]);
    complementary(p.upper[i] - x[i], solver.upper_multipliers()[i]);
  }
  return worst;
}

TEST(QuadraticProgram, FulfilsTheConditionsOfKarushKuhnAndTucker) {
  Random random(3);
  for (int t = 0; t < 300; ++t) {
    const Programme p = random.programme(1 + random.below(30), random.below(80));
    QuadraticProgram solver;
    ASSERT_EQ(solve(solver, p), Status::kSolved) << t;
    EXPECT_LE(error(solver, p), 1e-9) << t;
  }
}

TEST(QuadraticProgram, FindsTheBestOfAllActiveSets) {
  // Two variables, so that every set of at most two active constraints can be tried.
  Random random(4);
  for (int t = 0; t < 200; ++t) {
    const Programme p = random.programme(2, 4);
    Matrix all(8, 2);
    Vector offsets(8);
    all << p.A, Matrix::Identity(2, 2), -Matrix::Identity(2, 2);
    offsets << p.b, -p.lower, p.upper;
    const auto cost = [&](const Vector& x) { return 0.5 * x.dot(p.G * x) + p.g.dot(x); };
    double best = kInfinity;
    const auto consider = [&](const Vector& x) {
      if (x.allFinite() && (all * x + offsets).minCoeff() >= -1e-9) best = std::min(best, cost(x));
    };
    consider(-p.G.inverse() * p.g);
    for (int i = 0; i < 8; ++i) {
      Eigen::Matrix3d K;
      K << p.G, -all.row(i).transpose(), all.row(i), 0.0;
      consider((K.inverse() * Eigen::Vector3d(-p.g[0], -p.g[1], -offsets[i])).head(2));
      for (int j = 0; j < i; ++j) {
        Eigen::Matrix2d corner;
        corner << all.row(i), all.row(j);
        consider(corner.inverse() * Eigen::Vector2d(-offsets[i], -offsets[j]));
      }
    }
    QuadraticProgram solver;
    ASSERT_EQ(solve(solver, p), Status::kSolved) << t;
    EXPECT_NEAR(cost(solver.x()), best, 1e-8 * (1.0 + std::abs(best))) << t;
  }
}

TEST(QuadraticProgram, TakesDependentAndOppositeRows) {
  Random random(5);
  for (int t = 0; t < 200; ++t) {
    Programme p = random.programme(2 + random.below(20), 3 + random.below(40));
    const int m = static_cast<int>(p.b.size());
    // Row 1 the opposite of row 0, a band of width 0 or 1e-6; row 2 their double.
    p.b[0] = -p.A.row(0).dot(p.inside);
    p.A.row(1) = -p.A.row(0);
    p.b[1] = -p.b[0] + (t % 2 == 0 ? 0.0 : 1e-6);
    p.A.row(2) = 2.0 * p.A.row(0);
    p.b[2] = 2.0 * p.b[0];
    for (int r = 3; r < m; ++r) p.b[r] += 3.0;
    QuadraticProgram solver;
    ASSERT_EQ(solve(solver, p), Status::kSolved) << t;
    EXPECT_LE(error(solver, p), 1e-9) << t;
  }
}

TEST(QuadraticProgram, SaysWhatHasNoSolution) {
  Random random(6);
  for (int t = 0; t < 100; ++t) {
    Programme p = random.programme(1 + random.below(20), 2 + random.below(40));
    p.A.row(1) = -p.A.row(0);
    p.b[1] = -p.b[0] - 1e-3;
    QuadraticProgram solver;
    EXPECT_EQ(solve(solver, p), Status::kInfeasible) << t;
  }
  Programme p = random.programme(3, 1);
  p.A.setZero();
  p.b[0] = -1.0;
  QuadraticProgram solver;
  EXPECT_EQ(solve(solver, p), Status::kInfeasible);
  p = random.programme(3, 0);
  p.G(2, 2) = -1.0;
  EXPECT_EQ(solve(solver, p), Status::kNotConvex);
  p = random.programme(3, 2);
  p.g[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solve(solver, p), Status::kNotConvex);
}

TEST(QuadraticProgram, TakesInfiniteBoundsAndNoRows) {
  Random random(7);
  Programme p = random.programme(6, 0);
  p.lower.setConstant(-kInfinity);
  p.upper.setConstant(kInfinity);
  QuadraticProgram solver;
  ASSERT_EQ(solve(solver, p), Status::kSolved);
  EXPECT_LE((p.G * solver.x() + p.g).norm(), 1e-9);
  EXPECT_EQ(solver.steps(), 0);
}

TEST(QuadraticProgram, TakesFewStepsFromTheLastActiveSet) {
  Random random(8);
  int first = 0, next = 0;
  for (int t = 0; t < 50; ++t) {
    Programme p = random.programme(20, 60);
    QuadraticProgram solver;
    ASSERT_EQ(solve(solver, p), Status::kSolved);
    first += solver.steps();
    p.g += 1e-6 * random.matrix(20, 1);
    ASSERT_EQ(solve(solver, p), Status::kSolved);
    next += solver.steps();
    EXPECT_LE(error(solver, p), 1e-9);
  }
  EXPECT_LT(next, first);
}

}  // namespace
}  // namespace prospect::quadratic_program_test
