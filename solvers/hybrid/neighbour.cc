// SPDX-License-Identifier: Apache-2.0
#include "solvers/hybrid/neighbour.h"

#include <algorithm>

#include "solvers/hybrid/spread_value.h"
#include "solvers/sampling/additive_recurrence.h"

namespace prospect {

Eigen::VectorXd neighbour(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& z,
                          int i) {
  const int nu = problem.horizon().nu();
  const int M = problem.definition().M;
  Eigen::ArrayXd t = 0.5 + i * additive_recurrence_steps(2 + nu).array();
  t -= t.floor();
  const int length = 1 + std::min(M - 1, static_cast<int>(t[0] * M));
  const int start = std::min(M - length, static_cast<int>(t[1] * (M - length + 1)));
  Eigen::VectorXd x = z;
  for (int m = start; m < start + length; ++m) {
    for (int j = 0; j < nu; ++j) {
      const int at = m * nu + j;
      x[at] = spread_value(problem.lower()[at], problem.upper()[at], t[2 + j]);
    }
  }
  return x;
}

}  // namespace prospect
