// SPDX-License-Identifier: Apache-2.0
#include "solvers/descent_direction.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace prospect {
namespace {

/// y = argmin |N y - g| with y >= 0; returns g - N y.
Eigen::VectorXd residual_of_nnls(const Eigen::MatrixXd& N, const Eigen::VectorXd& g,
                                 Eigen::VectorXd& y) {
  const Eigen::Index count = N.cols();
  y.setZero(count);
  std::vector<char> passive(static_cast<std::size_t>(count), 0);
  Eigen::VectorXd residual = g;
  const double least = 1e-12 * (1.0 + g.norm());
  for (Eigen::Index round = 0; round < 3 * count; ++round) {
    // The column whose multiplier helps most.
    Eigen::Index best = -1;
    double most = least;
    for (Eigen::Index j = 0; j < count; ++j) {
      if (passive[static_cast<std::size_t>(j)]) continue;
      const double w = N.col(j).dot(residual);
      if (w > most * N.col(j).norm()) {
        best = j;
        most = w / N.col(j).norm();
      }
    }
    if (best < 0) break;
    passive[static_cast<std::size_t>(best)] = 1;
    for (Eigen::Index inner = 0; inner <= count; ++inner) {
      std::vector<Eigen::Index> at;
      for (Eigen::Index j = 0; j < count; ++j) {
        if (passive[static_cast<std::size_t>(j)]) at.push_back(j);
      }
      const Eigen::VectorXd z = N(Eigen::all, at).colPivHouseholderQr().solve(g);
      // As far towards z as no multiplier becomes negative.
      double step = 1.0;
      for (std::size_t k = 0; k < at.size(); ++k) {
        const double from = y[at[k]], to = z[static_cast<Eigen::Index>(k)];
        if (to <= 0.0) step = std::min(step, from > 0.0 ? from / (from - to) : 0.0);
      }
      for (std::size_t k = 0; k < at.size(); ++k) {
        double& value = y[at[k]];
        value += step * (z[static_cast<Eigen::Index>(k)] - value);
        if (step < 1.0 && !(value > std::numeric_limits<double>::epsilon())) {
          value = 0.0;
          passive[static_cast<std::size_t>(at[k])] = 0;
        }
      }
      if (step >= 1.0) break;
    }
    residual = g - N * y;
  }
  return residual;
}

}  // namespace

Eigen::VectorXd descent_direction(const Eigen::VectorXd& g, const Eigen::MatrixXd& A,
                                  const Eigen::VectorXd& x, Eigen::VectorXd* multipliers) {
  constexpr double kAtBound = 1e-12;
  const Eigen::Index n = g.size();
  std::vector<Eigen::Index> at_bound;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (x[i] <= kAtBound || x[i] >= 1.0 - kAtBound) at_bound.push_back(i);
  }
  Eigen::MatrixXd N =
      Eigen::MatrixXd::Zero(n, A.rows() + static_cast<Eigen::Index>(at_bound.size()));
  N.leftCols(A.rows()) = A.transpose();
  for (std::size_t k = 0; k < at_bound.size(); ++k) {
    N(at_bound[k], A.rows() + static_cast<Eigen::Index>(k)) = x[at_bound[k]] < 0.5 ? 1.0 : -1.0;
  }
  Eigen::VectorXd y;
  const Eigen::VectorXd d = -residual_of_nnls(N, g, y);
  if (multipliers) {
    multipliers->setZero(A.rows() + n);
    multipliers->head(A.rows()) = y.head(A.rows());
    for (std::size_t k = 0; k < at_bound.size(); ++k) {
      (*multipliers)[A.rows() + at_bound[k]] = y[A.rows() + static_cast<Eigen::Index>(k)];
    }
  }
  return d;
}

}  // namespace prospect
