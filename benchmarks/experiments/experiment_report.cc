#include "benchmarks/experiments/experiment_report.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <sstream>

#include "benchmarks/experiments/condition_comparison.h"

namespace prospect {
namespace {

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

std::string p_text(double p) { return p < 0.001 ? "< 0.001" : fixed(p, 3); }

void write(const ConditionComparison& c, std::ostringstream& out) {
  out << "\n`" << c.condition->name << "` against `" << c.condition->reference << "`, sensors "
      << c.sensors << ", " << c.group << ", " << c.pairs.size() << " pairs:\n\n"
      << "| | `" << c.condition->reference << "`, median | `" << c.condition->name
      << "`, median | pairs | mean difference [95 %] | ratio of means [95 %] | p |\n"
      << "|-|-|-|-|-|-|-|\n";
  for (const NumberComparison& n : c.numbers) {
    const int digits = n.number->digits;
    out << "| " << n.number->label << " | ";
    if (n.pairs == 0) {
      out << "- | - | 0 | - | - | - |\n";
      continue;
    }
    out << fixed(n.median_reference, digits) << " | " << fixed(n.median_condition, digits) << " | "
        << n.pairs;
    if (n.only_reference + n.only_condition > 0) {
      out << " (only one side: " << n.only_reference << " / " << n.only_condition << ")";
    }
    out << " | " << with_interval(n.difference, n.difference_interval, digits) << " | "
        << with_interval(n.ratio, n.ratio_interval, 2) << " | " << p_text(n.p) << " |\n";
  }
}

/// A line for each comparison, named by `name`: ratios of means of the chief numbers.
void write_ratios(const std::vector<ConditionComparison>& comparisons, const char* what,
                  std::string (*name)(const ConditionComparison&), std::ostringstream& out) {
  using Row = ExperimentRow;
  std::vector<std::size_t> columns;
  for (std::size_t k = 0; k < shown_numbers().size(); ++k) {
    for (const auto member : {&Row::losses, &Row::few_share, &Row::error_rms_m,
                              &Row::coverage_at_25_cm, &Row::coverage, &Row::plan_ms_p50}) {
      if (shown_numbers()[k].member == member) columns.push_back(k);
    }
  }
  out << "\nRatio of means [95 %] by " << what << ":\n\n| " << what << " | pairs |";
  for (const std::size_t k : columns) out << ' ' << shown_numbers()[k].label << " |";
  out << "\n|-|-|";
  for (std::size_t k = 0; k < columns.size(); ++k) out << "-|";
  out << '\n';
  for (const ConditionComparison& c : comparisons) {
    out << "| " << name(c) << " | " << c.pairs.size() << " |";
    for (const std::size_t k : columns) {
      const NumberComparison& n = c.numbers[k];
      out << ' ' << with_interval(n.ratio, n.ratio_interval, 2) << " |";
    }
    out << '\n';
  }
}

}  // namespace

std::string experiment_report(const std::vector<ExperimentRow>& rows) {
  std::ostringstream out;
  const std::vector<const ExperimentRow*> missions = last_rows(rows);
  out << "| sensors | condition | missions | ended |\n|-|-|-|-|\n";
  for (const char* sensors : {"model", "camera"}) {
    for (const Condition& condition : conditions()) {
      int count = 0;
      std::map<std::string, int> reasons;
      for (const ExperimentRow* row : missions) {
        if (row->sensors != sensors || row->condition != condition.name) continue;
        ++count;
        ++reasons[row->reason];
      }
      if (count == 0) continue;
      out << "| " << sensors << " | `" << condition.name << "` | " << count << " |";
      const char* between = " ";
      for (const auto& [reason, times] : reasons) {
        out << between << reason << ": " << times;
        between = ", ";
      }
      out << " |\n";
    }
  }
  const std::vector<ConditionComparison> all = compare_conditions(rows);
  if (all.size() > 1) {
    write_ratios(
        all, "condition",
        [](const ConditionComparison& c) {
          return "`" + c.condition->name + "` / `" + c.condition->reference + "`, " + c.sensors;
        },
        out);
  }
  for (const ConditionComparison& c : all) {
    write(c, out);
    const std::vector<ConditionComparison> worlds = by_world(c);
    if (!worlds.empty()) {
      write_ratios(
          worlds, "world", [](const ConditionComparison& world) { return world.group; }, out);
    }
    for (const ConditionComparison& group : by_group(c)) write(group, out);
  }
  return out.str();
}

}  // namespace prospect
