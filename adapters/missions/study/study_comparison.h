// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "adapters/missions/bench/resampled_means.h"
#include "adapters/missions/study/study_results.h"

namespace prospect {

/// One number of a setup against that of its reference. A pair lacks it if either side does.
struct NumberComparison {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const StudyNumber* number = nullptr;
  int pairs = 0, only_reference = 0, only_other = 0;
  // As shown (StudyNumber::scale); NaN where there is none.
  double median_reference = kNone, median_other = kNone;
  /// Mean of other - reference, and ratio of the means, other over reference. With 95 % of 4000
  /// resamples of the pairs (resampled_means.h).
  MeanInterval difference{kNone, kNone, kNone};
  MeanInterval ratio = difference;
  /// Of the signed-rank test (signed_rank_test.h), not corrected for the number of numbers.
  double p = kNone;
};

/// A setup against another one that differs from it in one thing, paired by world and seed, or by
/// set, problem and seed.
struct StudyComparison {
  std::size_t reference = 0, other = 0;  ///< StudyPlan::setups
  std::string label;                     ///< "without / with", "planner.N=20 / planner.N=12"
  std::string among;                     ///< what both have besides: "planner.solver=nlopt"; ""
  std::string input;                     ///< world or set; "": all
  std::vector<std::pair<const StudyRow*, const StudyRow*>> pairs;  ///< reference first; both done
  std::vector<NumberComparison> numbers;                           ///< study_numbers()
};

/// Every setup against the one with the first condition, and for each axis against the one with its
/// first value, all else alike; over all worlds or sets. Those without a pair are left out.
std::vector<StudyComparison> compare_setups(const StudyPlan& plan,
                                            const std::vector<StudyRow>& rows);

/// The same comparison in each of its worlds or sets; none if there is only one.
std::vector<StudyComparison> by_input(const StudyPlan& plan, const StudyComparison& comparison);

}  // namespace prospect
