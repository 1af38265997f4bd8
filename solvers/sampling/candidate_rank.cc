// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/candidate_rank.h"

#include <algorithm>
#include <cmath>

namespace prospect {

void fold_violations(const Eigen::ArrayXd& violation, double tolerance, Eigen::ArrayXd& cost) {
  double least = 0.0, most = 0.0;
  bool any = false;
  for (Eigen::Index s = 0; s < cost.size(); ++s) {
    if (violation[s] > tolerance) continue;
    least = any ? std::min(least, cost[s]) : cost[s];
    most = any ? std::max(most, cost[s]) : cost[s];
    any = true;
  }
  const double spread = std::max(most - least, 1e-9 * std::max(1.0, std::abs(most)));
  double largest = 0.0;
  for (Eigen::Index s = 0; s < cost.size(); ++s) {
    if (std::isfinite(violation[s])) largest = std::max(largest, violation[s]);
  }
  for (Eigen::Index s = 0; s < cost.size(); ++s) {
    if (violation[s] <= tolerance) continue;
    cost[s] = !std::isfinite(violation[s]) ? violation[s]
              : any                        ? most + spread * (0.1 + violation[s] / largest)
                                           : violation[s];
  }
}

}  // namespace prospect
