// SPDX-License-Identifier: Apache-2.0
#include "solvers/sqp/stage_curvature.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <random>
#include <vector>

#include "engine/support/eigenvalues.h"

namespace prospect::stage_curvature_test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr int kStates = 3, kNodes = 5, kVariables = 6;

class StageCurvatureTest : public testing::Test {
 protected:
  StageCurvatureTest() {
    curvature_.reset(kStates, kNodes);
    for (int k = 0; k < kNodes; ++k) {
      const Matrix M = matrix(kStates, kStates);
      H_.push_back(M + M.transpose());
      S_.push_back(k == 0 ? Matrix(Matrix::Zero(kStates, kVariables))
                          : matrix(kStates, kVariables));
    }
  }
  Matrix matrix(int rows, int columns) {
    return Matrix::NullaryExpr(rows, columns, [&] { return normal_(generator_); });
  }
  /// The gradient of 1/2 sum_k x_k^T H_k x_k.
  Matrix gradient(const Matrix& X) const {
    Matrix g(kStates, kNodes);
    for (int k = 0; k < kNodes; ++k) g.col(k) = H_[static_cast<std::size_t>(k)] * X.col(k);
    return g;
  }
  void difference(const Matrix& X) {
    for (int i = 0; i < kStates; ++i) {
      Matrix moved = X;
      moved.row(i).array() += 0.1;
      curvature_.difference(i, 0.1, gradient(X), gradient(moved));
    }
    curvature_.symmetrise();
  }
  /// Largest error of the nodes that count.
  double error() const {
    double worst = 0.0;
    for (int k = 1; k < kNodes; ++k) {
      const auto known = curvature_.hessians().middleCols(k * kStates, kStates);
      worst = std::max(worst, (known - H_[static_cast<std::size_t>(k)]).cwiseAbs().maxCoeff());
    }
    return worst;
  }

  std::mt19937 generator_{11};
  std::normal_distribution<double> normal_;
  std::vector<Matrix> H_, S_;
  StageCurvature curvature_;
};

TEST_F(StageCurvatureTest, DifferencesOfAQuadraticAreExact) {
  difference(matrix(kStates, kNodes));
  EXPECT_LE(error(), 1e-12);
}

TEST_F(StageCurvatureTest, RankOneUpdatesFindAQuadratic) {
  // As many steps as there are states suffice where no update is left out.
  Matrix X = matrix(kStates, kNodes);
  for (int i = 0; i < 12; ++i) {
    const Matrix next = X + matrix(kStates, kNodes);
    curvature_.update(next - X, gradient(next) - gradient(X));
    X = next;
  }
  EXPECT_LE(error(), 1e-8);
  // A way too short to tell anything changes nothing.
  const Matrix before = curvature_.hessians();
  curvature_.update(Matrix::Constant(kStates, kNodes, 1e-9), matrix(kStates, kNodes));
  EXPECT_EQ(curvature_.hessians(), before);
}

TEST_F(StageCurvatureTest, CondensesProjections) {
  constexpr double kLeast = 0.3;
  difference(matrix(kStates, kNodes));
  const Matrix drift = matrix(kStates, kNodes);
  Matrix hessian = Matrix::Zero(kVariables, kVariables);
  Vector by_drift = Vector::Zero(kVariables);
  curvature_.condense(kLeast, S_, drift, hessian, by_drift);
  Matrix expected = Matrix::Zero(kVariables, kVariables);
  Vector expected_gradient = Vector::Zero(kVariables);
  for (std::size_t k = 1; k < kNodes; ++k) {
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(H_[k]);
    ASSERT_LT(eigen.eigenvalues().minCoeff(), kLeast);
    const Matrix P = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(kLeast).asDiagonal() *
                     eigen.eigenvectors().transpose();
    expected += S_[k].transpose() * P * S_[k];
    expected_gradient += S_[k].transpose() * P * drift.col(static_cast<Eigen::Index>(k));
  }
  EXPECT_LE((hessian - expected).norm(), 1e-9);
  EXPECT_LE((by_drift - expected_gradient).norm(), 1e-9);
}

TEST_F(StageCurvatureTest, ANodeOfWhichNothingIsKnownAddsNothing) {
  Matrix hessian = Matrix::Zero(kVariables, kVariables);
  Vector by_drift = Vector::Zero(kVariables);
  curvature_.condense(0.3, S_, matrix(kStates, kNodes), hessian, by_drift);
  EXPECT_TRUE(hessian.isZero(0.0));
  EXPECT_TRUE(by_drift.isZero(0.0));
}

}  // namespace
}  // namespace prospect::stage_curvature_test
