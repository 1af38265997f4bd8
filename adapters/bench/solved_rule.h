#pragma once

#include <algorithm>
#include <cmath>

namespace prospect {

/// Largest violation of a constraint that counts as feasible, whatever a back end was told.
constexpr double kFeasible = 1e-6;

/// What counts as solved: a feasible point of cost at most
///
///   target = best + max(relative |best|, absolute)
///
/// `best` is the best cost known, `relative` 0.01 unless the user says otherwise. `absolute` takes
/// over where the best is near 0 and a share of it means nothing.
struct SolvedRule {
  double relative = 0.01;
  double absolute = 1e-3;

  double slack(double best) const { return std::max(relative * std::abs(best), absolute); }
  double target(double best) const { return best + slack(best); }
  bool solved(double cost, double violation, double best) const {
    return violation <= kFeasible && cost <= target(best);
  }
  /// How far a cost is from the best, in such a measure that `relative` is just solved; a cost
  /// below the best counts as the best. [-]
  double gap(double cost, double best) const {
    return relative * std::max(0.0, cost - best) / slack(best);
  }
};

}  // namespace prospect
