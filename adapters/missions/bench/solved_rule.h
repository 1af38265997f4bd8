// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace prospect {

/// Largest violation of a constraint that counts as feasible, whatever a back end was told.
constexpr double kFeasible = 1e-6;

/// What counts as solved: a feasible point of cost at most
///
///   target = best + max(relative |best|, absolute)      where costs have a unit that is known
///   target = best + relative difference                 where absolute is 0
///
/// `best` is the best cost known, `relative` 0.01 unless the user says otherwise. `absolute` takes
/// over where the best is near 0 and a share of it means nothing. `difference` is one of costs that
/// matters in the problem, so that neither an offset nor the scale of its cost changes what is
/// solved (More and Wild 2009: that of the start and the best).
struct SolvedRule {
  double relative = 0.01;
  double absolute = 1e-3;
  double difference = 0.0;

  double slack(double best) const {
    if (absolute > 0.0) return std::max(relative * std::abs(best), absolute);
    return relative * difference;
  }
  double target(double best) const { return best + slack(best); }
  bool solved(double cost, double violation, double best) const {
    return violation <= kFeasible && cost <= target(best);
  }
  /// How far a cost is from the best, in such a measure that `relative` is just solved; a cost
  /// below the best counts as the best. [-]
  double gap(double cost, double best) const {
    return cost > best ? relative * (cost - best) / slack(best) : 0.0;
  }
};

}  // namespace prospect
