// SPDX-License-Identifier: Apache-2.0
#include "solvers/limited_memory_bfgs.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "engine/support/eigenvalues.h"

namespace prospect::limited_memory_bfgs_test {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr int n = 6;

Vector random_vector(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Vector::NullaryExpr(n, [&] { return uniform(generator); });
}

Matrix positive_definite(std::mt19937_64& generator) {
  Matrix A(n, n);
  for (int i = 0; i < n; ++i) A.col(i) = random_vector(generator);
  return A * A.transpose() + 0.1 * Matrix::Identity(n, n);
}

double least_eigenvalue(const Matrix& B) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(B).eigenvalues().minCoeff();
}

TEST(LimitedMemoryBfgs, FitsTheNewestPairAndStaysPositiveDefinite) {
  std::mt19937_64 generator(2);
  const Matrix Q = positive_definite(generator);
  LimitedMemoryBfgs bfgs(n, 4);
  EXPECT_EQ(bfgs.matrix(), Matrix(Matrix::Identity(n, n)));
  for (int i = 0; i < 20; ++i) {
    const Vector s = random_vector(generator), y = Q * s;
    bfgs.update(s, y);
    EXPECT_LE((bfgs.matrix() * s - y).norm(), 1e-10 * y.norm());
    EXPECT_LE((bfgs.matrix() - bfgs.matrix().transpose()).norm(), 1e-10);
    EXPECT_GT(least_eigenvalue(bfgs.matrix()), 0.0);
  }
}

TEST(LimitedMemoryBfgs, FindsTheHessianOfAQuadraticFunction) {
  std::mt19937_64 generator(3);
  const Matrix Q = positive_definite(generator);
  LimitedMemoryBfgs bfgs(n, 300);
  for (int i = 0; i < 300; ++i) {
    const Vector s = random_vector(generator);
    bfgs.update(s, Q * s);
  }
  EXPECT_LE((bfgs.matrix() - Q).norm(), 1e-6 * Q.norm());
}

TEST(LimitedMemoryBfgs, ForgetsAllButTheNewestPairs) {
  std::mt19937_64 generator(4);
  const Matrix Q = positive_definite(generator), other = positive_definite(generator);
  LimitedMemoryBfgs with_past(n, 3), without(n, 3);
  for (int i = 0; i < 5; ++i) {
    const Vector s = random_vector(generator);
    with_past.update(s, other * s);
  }
  for (int i = 0; i < 3; ++i) {
    const Vector s = random_vector(generator);
    with_past.update(s, Q * s);
    without.update(s, Q * s);
  }
  EXPECT_EQ(with_past.matrix(), without.matrix());
}

TEST(LimitedMemoryBfgs, LeavesOutPairsWithoutPositiveCurvature) {
  std::mt19937_64 generator(5);
  const Matrix Q = positive_definite(generator);
  LimitedMemoryBfgs bfgs(n, 5);
  const Vector s = random_vector(generator);
  bfgs.update(s, Q * s);
  const Matrix before = bfgs.matrix();
  bfgs.update(Vector::Zero(n), Vector::Zero(n));  // no step at all: not even counted
  bfgs.update(s, -Q * s);
  EXPECT_EQ(bfgs.matrix(), before);
  bfgs.update(s, -Q * s);  // the second in a row: the function is another one by now
  EXPECT_EQ(bfgs.matrix(), Matrix(Matrix::Identity(n, n)));
}

}  // namespace
}  // namespace prospect::limited_memory_bfgs_test
