// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace prospect {

/// lower + (upper - lower) clamp(3/2 t - 1/4, 0, 1) for t in [0, 1): of values of t that fill it
/// evenly a sixth lies on each bound. Optimal inputs are often full speed, full turn or none.
inline double spread_value(double lower, double upper, double t) {
  const double share = std::clamp(1.5 * t - 0.25, 0.0, 1.0);
  return std::min(upper, lower + (upper - lower) * share);
}

}  // namespace prospect
