// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/solve_numbers.h"

#include <limits>

namespace prospect {

const std::vector<StudyNumber>& solve_number_list() {
  static const std::vector<StudyNumber> numbers = {
      {"solved", "solved [%]", 100.0, 1, true, false, true},
      {"gap", "gap to the best known [%]", 100.0, 3, true, false, true},
      {"cost", "cost", 1.0, 6, false, false},
      {"evaluations_to_target", "evaluations to target", 1.0, 0, true, false, true},
      {"cost_evaluations", "evaluations", 1.0, 0, true, false},
      {"gradient_evaluations", "of them with gradient", 1.0, 0, true, false},
      {"ms_to_target", "time to target [ms]", 1.0, 3, true, true, true},
      {"wall_ms", "whole solve [ms]", 1.0, 3, true, true, true},
      {"overrun_ms", "past the deadline [ms]", 1.0, 3, true, true, true},
  };
  return numbers;
}

std::vector<double> values_of(const BenchRow& row) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!row.supported) {
    return {0.0, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  }
  const bool ended = feasible(row);
  return {row.solved ? 1.0 : 0.0,
          row.gap,
          ended ? row.cost : kNone,
          row.evaluations_to_target,
          static_cast<double>(row.counters.cost_evaluations),
          static_cast<double>(row.counters.gradient_evaluations),
          1e3 * row.seconds_to_target,
          1e3 * row.seconds,
          row.deadline > 0.0 ? 1e3 * row.overrun : kNone};
}

}  // namespace prospect
