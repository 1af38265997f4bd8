// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace prospect {

/// Wilcoxon's signed-rank test of paired differences d_i (F. Wilcoxon, Individual Comparisons by
/// Ranking Methods, Biometrics Bulletin 1, 1945): is their distribution symmetric about zero?
///
/// Differences of zero are dropped, as Wilcoxon does, and n counts the others. Their magnitudes are
/// ranked, equal ones with the mean of their ranks; W+ and W- are the sums of ranks of the positive
/// and the negative ones. The p value is two-sided. For n <= 25 it is exact, by counting the signs
/// (2^n, all alike) that give each sum, with ties given as they are; above, the normal
/// approximation with variance n (n+1) (2n+1) / 24 - sum_ties (t^3 - t) / 48 and continuity
/// correction 1/2. n = 0 gives p = 1.
struct SignedRankTest {
  int n = 0;      ///< differences that are not zero
  int zeros = 0;  ///< differences dropped
  double w_plus = 0.0, w_minus = 0.0;
  bool exact = true;
  double p = 1.0;
};

/// The differences must be finite; std::invalid_argument if not.
SignedRankTest signed_rank_test(const std::vector<double>& differences);

}  // namespace prospect
