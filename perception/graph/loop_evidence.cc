// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/loop_evidence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "engine/support/eigenvalues.h"
#include "perception/odometry/se3.h"

namespace prospect {

using Matrix6d = LoopTest::Matrix6d;
using Vector6d = LoopTest::Vector6d;

LoopTest::LoopTest(const Vector6d& r, const Matrix6d& P, const Matrix6d& W) {
  const Eigen::LLT<Matrix6d> L(P);
  const Matrix6d half = L.matrixL().solve(W);
  const Matrix6d M = L.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(M);
  const Vector6d white = L.matrixL().solve(r);
  squares_ = (eigen.eigenvectors().transpose() * white).cwiseAbs2();
  lambda_ = eigen.eigenvalues().cwiseMax(0.0);
}

LoopEvidence LoopTest::evidence(double s, double nu) const {
  LoopEvidence e;
  double volume = 0.0, dimensions = 0.0;
  for (int k = 0; k < 6; ++k) {
    const double lambda = lambda_[k] / (s * s), share = lambda / (1.0 + lambda);
    volume += 0.5 * std::log1p(lambda);
    dimensions += share;
    e.chi2 += squares_[k] / (s * s) * share;
  }
  e.score = volume - 0.5 * (nu + dimensions) * std::log1p(e.chi2 / nu);
  e.chance = -volume - std::lgamma(0.5 * dimensions + 1.0);
  if (dimensions > 0.0) {
    e.chance += 0.5 * dimensions * std::log(0.5 * std::max(dimensions, e.chi2));
  }
  return e;
}

Matrix6d pose_spread(const std::vector<Eigen::Isometry3d>& poses) {
  const std::size_t n = poses.size(), chosen = std::min<std::size_t>(n, 64);
  Matrix6d W = Matrix6d::Zero();
  for (std::size_t i = 0; i < chosen; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vector6d x = log_se3(poses[j * n / chosen].inverse() * poses[i * n / chosen]);
      W += x * x.transpose();
    }
  }
  return chosen < 2 ? W : Matrix6d(W * 2.0 / static_cast<double>(chosen * (chosen - 1)));
}

double share_of_right(const std::vector<double>& scores, int known) {
  double share = 0.5;
  for (int i = 0; i < 20; ++i) {
    double right = 1.0 + known;
    for (const double score : scores) {
      right += 1.0 / (1.0 + (1.0 - share) / share * std::exp(-score));
    }
    share = right / (2.0 + known + static_cast<double>(scores.size()));
  }
  return share;
}

}  // namespace prospect
