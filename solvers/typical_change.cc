// SPDX-License-Identifier: Apache-2.0
#include "solvers/typical_change.h"

#include <algorithm>
#include <cmath>

namespace prospect {

Eigen::VectorXd typical_change(const Eigen::VectorXd& x, const Eigen::VectorXd& lower,
                               const Eigen::VectorXd& upper) {
  constexpr double kFar = 2.0;
  return (upper - lower).array().min(kFar * x.array().abs().max(1.0));
}

bool is_plain_cost(double cost, double unit) {
  constexpr double kLeastShare = 0x1p-6;
  return unit <= kLargestUnit && unit >= kLeastShare * std::max(1.0, std::abs(cost));
}

double size_of_cost(double cost, double unit) {
  constexpr double kMostUnits = 0x1p4;
  if (unit > kLargestUnit || is_plain_cost(cost, unit)) {
    return std::min(std::max(1.0, std::abs(cost)), kMostUnits * unit);
  }
  return unit;
}

}  // namespace prospect
