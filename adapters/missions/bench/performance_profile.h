// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace prospect {

/// The share of problems that a solver solves within a factor of the best: a step function.
struct PerformanceProfile {
  struct Step {
    double ratio = 1.0;  ///< tau >= 1, ascending
    double share = 0.0;  ///< rho(tau), of all problems
  };
  std::vector<Step> steps;  ///< the share stays between two steps; 0 before the first
  double at(double ratio) const;
};

/// Dolan-Moré performance profiles. measures[s][p] > 0 is what solver s spends to solve problem p,
/// infinite if it does not;
///
///   r_sp = measures[s][p] / min_s' measures[s'][p],    rho_s(tau) = |{p : r_sp <= tau}| / P.
///
/// A problem that nobody solves counts in P and for nobody. All solvers have the same number P of
/// problems; with none, no profile has a step.
/// Source: Dolan and Moré, Benchmarking optimization software with performance profiles (2002).
std::vector<PerformanceProfile> performance_profiles(
    const std::vector<std::vector<double>>& measures);

}  // namespace prospect
