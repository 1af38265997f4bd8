#include "benchmarks/experiments/experiment_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <map>
#include <sstream>
#include <tuple>
#include <utility>

#include "adapters/worlds/builtin_worlds.h"
#include "benchmarks/experiments/conditions.h"
#include "benchmarks/experiments/paired_bootstrap.h"
#include "benchmarks/experiments/signed_rank_test.h"

namespace prospect {
namespace {

/// How a number of the table is shown.
struct Shown {
  const char* label;
  double ExperimentRow::*member;
  double scale;
  int digits;
  bool ratio;  ///< of positive numbers; one with a sign has none
};

const std::vector<Shown>& shown() {
  using Row = ExperimentRow;
  static const std::vector<Shown> all = {
      {"losses of localization", &Row::losses, 1.0, 1, true},
      {"time with fewer than N_min features [%]", &Row::few_share, 100.0, 1, true},
      {"position error, RMS [m]", &Row::error_rms_m, 1.0, 3, true},
      {"position error, final [m]", &Row::error_final_m, 1.0, 3, true},
      {"position error, largest [m]", &Row::error_max_m, 1.0, 3, true},
      {"position error at 80 % coverage [m]", &Row::error_at_80_m, 1.0, 3, true},
      {"drift [mm/m]", &Row::drift_m_per_m, 1000.0, 1, true},
      {"coverage when the error passes 0.1 m [%]", &Row::coverage_at_10_cm, 100.0, 1, true},
      {"coverage when it passes 0.25 m [%]", &Row::coverage_at_25_cm, 100.0, 1, true},
      {"coverage when it passes 0.5 m [%]", &Row::coverage_at_50_cm, 100.0, 1, true},
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

std::string fixed(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", digits, value);
  return buffer.data();
}

std::string with_interval(double value, const Interval& i, int digits) {
  if (!std::isfinite(value)) return "-";
  return fixed(value, digits) + " [" + fixed(i.low, digits) + ", " + fixed(i.high, digits) + "]";
}

/// Not a number without values; the mean of the two in the middle of an even number.
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? std::numeric_limits<double>::quiet_NaN()
                : 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

std::string p_text(double p) { return p < 0.001 ? "< 0.001" : fixed(p, 3); }

std::string group_of(const std::string& world) {
  if (world.rfind("plan:", 0) == 0) return "floor plans";
  const std::vector<std::string> builtin = builtin_world_names();
  return std::find(builtin.begin(), builtin.end(), world) != builtin.end() ? "built-in worlds"
                                                                           : "worlds from files";
}

using Pair = std::pair<const ExperimentRow*, const ExperimentRow*>;  // reference, condition

void compare(const std::vector<Pair>& pairs, const Condition& condition, std::ostringstream& out) {
  out << "| | `" << condition.reference << "`, median | `" << condition.name
      << "`, median | pairs | mean difference [95 %] | ratio of means [95 %] | p |\n"
      << "|-|-|-|-|-|-|-|\n";
  for (const Shown& number : shown()) {
    std::vector<double> first, second, difference;
    int only_first = 0, only_second = 0;
    for (const auto& [reference, other] : pairs) {
      const double a = number.scale * reference->*number.member;
      const double b = number.scale * other->*number.member;
      const bool has_a = std::isfinite(a), has_b = std::isfinite(b);
      only_first += has_a && !has_b;
      only_second += !has_a && has_b;
      if (!has_a || !has_b) continue;
      first.push_back(a);
      second.push_back(b);
      difference.push_back(b - a);
    }
    out << "| " << number.label << " | ";
    if (first.empty()) {
      out << "- | - | 0 | - | - | - |\n";
      continue;
    }
    out << fixed(median(first), number.digits) << " | " << fixed(median(second), number.digits)
        << " | " << first.size();
    if (only_first + only_second > 0) {
      out << " (only one side: " << only_first << " / " << only_second << ")";
    }
    out << " | "
        << with_interval(mean_difference(first, second),
                         paired_bootstrap(first, second, mean_difference), number.digits)
        << " | "
        << (number.ratio ? with_interval(ratio_of_means(first, second),
                                         paired_bootstrap(first, second, ratio_of_means), 2)
                         : "-")
        << " | " << p_text(signed_rank_test(difference).p) << " |\n";
  }
}

}  // namespace

std::string experiment_report(const std::vector<ExperimentRow>& rows) {
  std::ostringstream out;
  std::map<std::tuple<std::string, std::string, std::string, std::uint64_t>, const ExperimentRow*>
      by_key;
  for (const ExperimentRow& row : rows) {
    by_key[{row.sensors, row.condition, row.world, row.seed}] = &row;
  }

  out << "| sensors | condition | missions | ended |\n|-|-|-|-|\n";
  for (const char* sensors : {"model", "camera"}) {
    for (const Condition& condition : conditions()) {
      int missions = 0;
      std::map<std::string, int> reasons;
      for (const auto& [key, row] : by_key) {
        if (row->sensors != sensors || row->condition != condition.name) continue;
        ++missions;
        ++reasons[row->reason];
      }
      if (missions == 0) continue;
      out << "| " << sensors << " | `" << condition.name << "` | " << missions << " |";
      const char* between = " ";
      for (const auto& [reason, count] : reasons) {
        out << between << reason << ": " << count;
        between = ", ";
      }
      out << " |\n";
    }
  }

  for (const char* sensors : {"model", "camera"}) {
    for (const Condition& condition : conditions()) {
      if (condition.reference.empty()) continue;
      std::vector<Pair> all;
      std::map<std::string, std::vector<Pair>> groups;
      for (const auto& [key, row] : by_key) {
        if (row->sensors != sensors || row->condition != condition.name) continue;
        const auto reference = by_key.find({sensors, condition.reference, row->world, row->seed});
        if (reference == by_key.end()) continue;
        all.emplace_back(reference->second, row);
        groups[group_of(row->world)].emplace_back(reference->second, row);
      }
      if (all.empty()) continue;
      out << "\n`" << condition.name << "` against `" << condition.reference << "`, sensors "
          << sensors << ", all worlds, " << all.size() << " pairs:\n\n";
      compare(all, condition, out);
      if (groups.size() < 2) continue;
      for (const auto& [group, pairs] : groups) {
        out << "\n`" << condition.name << "` against `" << condition.reference << "`, sensors "
            << sensors << ", " << group << ", " << pairs.size() << " pairs:\n\n";
        compare(pairs, condition, out);
      }
    }
  }
  return out.str();
}

}  // namespace prospect
