// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/bench/bench_table.h"
#include "adapters/missions/bench/resampled_means.h"

namespace prospect {

/// A number of one back end in two benches, paired by problem, deadline and seed.
struct PairedNumber {
  std::string name;
  int pairs = 0;  ///< that have it in both
  /// Of shares and gaps the mean difference, second - first; of times and evaluations the geometric
  /// mean of the ratios, second / first. With 95 % (resampled_means.h).
  MeanInterval change;
  bool ratio = false;
  double p = 1.0;             ///< sign_flip_p() of differences, or of logarithms of ratios
  double corrected = 1.0;     ///< p, corrected for all numbers of the comparison (S. Holm, 1979)
  bool beyond_noise = false;  ///< corrected < 0.05
};

/// One back end under one deadline in two benches.
struct SolverComparison {
  std::string solver;
  double deadline = 0.0;
  int pairs = 0;
  int only_first_solved = 0, only_second_solved = 0;
  /// Of pairs without a deadline: those whose cost or counts of evaluations differ. They repeat to
  /// the bit, so a difference is none of chance.
  int changed = 0;
  std::vector<PairedNumber> numbers;  ///< solved, gap, evaluations to target, time to target, time
};

struct BenchComparison {
  std::string first, second;            ///< folders
  int only_first = 0, only_second = 0;  ///< rows that the other one lacks
  std::vector<std::string> different;   ///< what measured them differs in this
  std::vector<SolverComparison> solvers;
};

/// Compares what two benches have in common, judged by the best cost that either knows. Seeds of
/// one problem count as one. Throws InputError in one line if a folder holds no bench, if a problem
/// of the same name is another one there, or if they have no row in common.
BenchComparison compare_benches(const std::string& first, const std::string& second,
                                double relative_tolerance);

/// For a terminal.
std::string comparison_text(const BenchComparison& comparison);
nlohmann::ordered_json comparison_json(const BenchComparison& comparison);

}  // namespace prospect
