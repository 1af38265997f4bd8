#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/experiments/conditions.h"
#include "benchmarks/experiments/experiment_row.h"
#include "benchmarks/experiments/paired_bootstrap.h"

namespace prospect {

/// How a number of a row is shown.
struct ShownNumber {
  const char* label;
  double ExperimentRow::*member;
  double scale;
  int digits;
  bool ratio;  ///< of positive numbers; one with a sign has none
};
const std::vector<ShownNumber>& shown_numbers();

/// One number of a condition against that of its reference. A pair lacks it if either mission does.
struct NumberComparison {
  const ShownNumber* number = nullptr;
  int pairs = 0, only_reference = 0, only_condition = 0;
  // In the unit of ShownNumber; NaN where there is none.
  double median_reference = ExperimentRow::kNone, median_condition = ExperimentRow::kNone;
  double difference = ExperimentRow::kNone;  ///< mean of condition - reference
  double ratio = ExperimentRow::kNone;       ///< of the means, condition over reference
  /// 95 % (paired_bootstrap.h).
  Interval difference_interval{ExperimentRow::kNone, ExperimentRow::kNone};
  Interval ratio_interval{ExperimentRow::kNone, ExperimentRow::kNone};
  /// Of the signed-rank test (signed_rank_test.h), not corrected for the number of numbers.
  double p = ExperimentRow::kNone;
};

/// A condition against its reference (conditions.h), paired by sensors, world and seed.
struct ConditionComparison {
  const Condition* condition = nullptr;
  std::string sensors;
  std::string group;  ///< of worlds, or one of them; "all worlds" for all
  std::vector<std::pair<const ExperimentRow*, const ExperimentRow*>> pairs;  ///< reference first
  std::vector<NumberComparison> numbers;                                     ///< one a shown number
};

/// The last row of each mission (sensors, condition, world, seed), in that order.
std::vector<const ExperimentRow*> last_rows(const std::vector<ExperimentRow>& rows);

/// Over all worlds; sensors "model" first, conditions in the order of conditions(). Points into
/// `rows`.
std::vector<ConditionComparison> compare_conditions(const std::vector<ExperimentRow>& rows);

/// The same comparison in each group of its worlds (built in; floor plans; from files), and in each
/// of its worlds: in the order of their names, none if there is only one.
std::vector<ConditionComparison> by_group(const ConditionComparison& comparison);
std::vector<ConditionComparison> by_world(const ConditionComparison& comparison);

}  // namespace prospect
