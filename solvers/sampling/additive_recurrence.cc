// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/additive_recurrence.h"

#include <cmath>

namespace prospect {

Eigen::VectorXd additive_recurrence_steps(int dimensions) {
  double phi = 2.0;
  for (int i = 0; i < 60; ++i) phi = std::pow(1.0 + phi, 1.0 / (dimensions + 1.0));
  Eigen::VectorXd steps(dimensions);
  for (int d = 0; d < dimensions; ++d) steps[d] = std::pow(phi, -(d + 1.0));
  return steps;
}

}  // namespace prospect
