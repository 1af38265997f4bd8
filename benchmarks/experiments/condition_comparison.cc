#include "benchmarks/experiments/condition_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <tuple>

#include "adapters/worlds/builtin_worlds.h"
#include "benchmarks/experiments/signed_rank_test.h"

namespace prospect {
namespace {

/// Not a number without values; the mean of the two in the middle of an even number.
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? std::numeric_limits<double>::quiet_NaN()
                : 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

std::string group_of(const std::string& world) {
  if (world.rfind("plan:", 0) == 0) return "floor plans";
  const std::vector<std::string> builtin = builtin_world_names();
  return std::find(builtin.begin(), builtin.end(), world) != builtin.end() ? "built-in worlds"
                                                                           : "worlds from files";
}

NumberComparison compare(
    const std::vector<std::pair<const ExperimentRow*, const ExperimentRow*>>& pairs,
    const ShownNumber& number) {
  NumberComparison c;
  c.number = &number;
  std::vector<double> first, second, difference;
  for (const auto& [reference, other] : pairs) {
    const double a = number.scale * reference->*number.member;
    const double b = number.scale * other->*number.member;
    const bool has_a = std::isfinite(a), has_b = std::isfinite(b);
    c.only_reference += has_a && !has_b;
    c.only_condition += !has_a && has_b;
    if (!has_a || !has_b) continue;
    first.push_back(a);
    second.push_back(b);
    difference.push_back(b - a);
  }
  c.pairs = static_cast<int>(first.size());
  if (first.empty()) return c;
  c.median_reference = median(first);
  c.median_condition = median(second);
  c.difference = mean_difference(first, second);
  c.difference_interval = paired_bootstrap(first, second, mean_difference);
  if (number.ratio) {
    c.ratio = ratio_of_means(first, second);
    c.ratio_interval = paired_bootstrap(first, second, ratio_of_means);
  }
  c.p = signed_rank_test(difference).p;
  return c;
}

void compare_all_numbers(ConditionComparison& c) {
  for (const ShownNumber& number : shown_numbers()) c.numbers.push_back(compare(c.pairs, number));
}

/// By name(world), in the order of the names; none if all pairs have the same.
std::vector<ConditionComparison> split(const ConditionComparison& c,
                                       std::string (*name)(const std::string& world)) {
  std::map<std::string, ConditionComparison> parts;
  for (const auto& pair : c.pairs) {
    const std::string part = name(pair.first->world);
    parts.try_emplace(part, ConditionComparison{c.condition, c.sensors, part, {}, {}})
        .first->second.pairs.push_back(pair);
  }
  std::vector<ConditionComparison> all;
  if (parts.size() < 2) return all;
  for (auto& [part, comparison] : parts) {
    compare_all_numbers(comparison);
    all.push_back(std::move(comparison));
  }
  return all;
}

using Key = std::tuple<std::string, std::string, std::string, std::uint64_t>;

std::map<Key, const ExperimentRow*> by_mission(const std::vector<ExperimentRow>& rows) {
  std::map<Key, const ExperimentRow*> found;
  for (const ExperimentRow& row : rows) {
    found[{row.sensors, row.condition, row.world, row.seed}] = &row;
  }
  return found;
}

}  // namespace

const std::vector<ShownNumber>& shown_numbers() {
  using Row = ExperimentRow;
  static const std::vector<ShownNumber> all = {
      {"losses of localization", &Row::losses, 1.0, 1, true},
      {"time with fewer than N_min features [%]", &Row::few_share, 100.0, 1, true},
      {"position error, RMS [m]", &Row::error_rms_m, 1.0, 3, true},
      {"position error, final [m]", &Row::error_final_m, 1.0, 3, true},
      {"position error, largest [m]", &Row::error_max_m, 1.0, 3, true},
      {"position error at 80 % coverage [m]", &Row::error_at_80_m, 1.0, 3, true},
      {"drift [mm/m]", &Row::drift_m_per_m, 1000.0, 1, true},
      {"relative pose error over 10 m [mm/m]", &Row::rpe_10_m_per_m, 1000.0, 1, true},
      {"coverage when the error passes 0.1 m [%]", &Row::coverage_at_10_cm, 100.0, 1, true},
      {"coverage when it passes 0.25 m [%]", &Row::coverage_at_25_cm, 100.0, 1, true},
      {"coverage when it passes 0.5 m [%]", &Row::coverage_at_50_cm, 100.0, 1, true},
      {"coverage after 60 s [%]", &Row::coverage_at_60_s, 100.0, 1, true},
      {"coverage after 120 s [%]", &Row::coverage_at_120_s, 100.0, 1, true},
      {"coverage after 20 m [%]", &Row::coverage_at_20_m, 100.0, 1, true},
      {"coverage after 40 m [%]", &Row::coverage_at_40_m, 100.0, 1, true},
      {"coverage at the end [%]", &Row::coverage, 100.0, 1, true},
      {"time to 90 % [s]", &Row::time_to_90_s, 1.0, 0, true},
      {"duration [s]", &Row::duration_s, 1.0, 0, true},
      {"path [m]", &Row::path_length_m, 1.0, 1, true},
      {"collisions", &Row::collisions, 1.0, 1, true},
      {"predicted features, relative error", &Row::prediction_error, 1.0, 3, true},
      {"predicted features, relative bias", &Row::prediction_bias, 1.0, 3, false},
      {"replanning, median [ms]", &Row::plan_ms_p50, 1.0, 1, true},
  };
  return all;
}

std::vector<const ExperimentRow*> last_rows(const std::vector<ExperimentRow>& rows) {
  std::vector<const ExperimentRow*> last;
  for (const auto& [key, row] : by_mission(rows)) last.push_back(row);
  return last;
}

std::vector<ConditionComparison> compare_conditions(const std::vector<ExperimentRow>& rows) {
  const std::map<Key, const ExperimentRow*> missions = by_mission(rows);
  std::vector<ConditionComparison> comparisons;
  for (const char* sensors : {"model", "camera"}) {
    for (const Condition& condition : conditions()) {
      if (condition.reference.empty()) continue;
      ConditionComparison all{&condition, sensors, "all worlds", {}, {}};
      for (const auto& [key, row] : missions) {
        if (row->sensors != sensors || row->condition != condition.name) continue;
        const auto reference = missions.find({sensors, condition.reference, row->world, row->seed});
        if (reference == missions.end()) continue;
        all.pairs.emplace_back(reference->second, row);
      }
      if (all.pairs.empty()) continue;
      compare_all_numbers(all);
      comparisons.push_back(std::move(all));
    }
  }
  return comparisons;
}

std::vector<ConditionComparison> by_group(const ConditionComparison& comparison) {
  return split(comparison, group_of);
}

std::vector<ConditionComparison> by_world(const ConditionComparison& comparison) {
  return split(comparison, [](const std::string& world) { return world; });
}

}  // namespace prospect
