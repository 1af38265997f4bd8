// SPDX-License-Identifier: Apache-2.0
#include "solvers/hybrid/spread_candidates.h"

#include <algorithm>
#include <cmath>

#include "solvers/hybrid/spread_value.h"
#include "solvers/sampling/additive_recurrence.h"

namespace prospect {

Eigen::MatrixXd spread_candidates(const Problem& problem, int count, int segments) {
  const int nu = problem.horizon().nu();
  const int M = problem.definition().M;
  const int stretches = std::clamp(segments, 1, M);
  const Eigen::VectorXd step = additive_recurrence_steps(stretches * nu);
  Eigen::MatrixXd candidates(problem.num_variables(), std::max(count, 0));
  if (count < 1) return candidates;
  candidates.col(0) = problem.lower().cwiseMax(0.0).cwiseMin(problem.upper());
  for (Eigen::Index i = 1; i < candidates.cols(); ++i) {
    for (int m = 0; m < M; ++m) {
      const int segment = m * stretches / M;
      for (int j = 0; j < nu; ++j) {
        const double t = 0.5 + static_cast<double>(i) * step[segment * nu + j];
        const int at = m * nu + j;
        candidates(at, i) =
            spread_value(problem.lower()[at], problem.upper()[at], t - std::floor(t));
      }
    }
  }
  return candidates;
}

}  // namespace prospect
