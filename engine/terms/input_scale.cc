// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/input_scale.h"

#include <algorithm>
#include <cmath>

namespace prospect {

Eigen::VectorXd input_scale(const InputLimits& limits) {
  Eigen::VectorXd R(limits.lower.size());
  for (Eigen::Index j = 0; j < R.size(); ++j) {
    const double largest = std::max(std::abs(limits.lower[j]), std::abs(limits.upper[j]));
    R[j] = std::isfinite(largest) && largest > 0.0 ? 1.0 / (largest * largest) : 1.0;
  }
  return R;
}

}  // namespace prospect
