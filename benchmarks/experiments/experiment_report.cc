#include "benchmarks/experiments/experiment_report.h"

#include <array>
#include <cmath>
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
  for (const ConditionComparison& c : compare_conditions(rows)) write(c, out);
  return out.str();
}

}  // namespace prospect
