// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/comparison_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <sstream>
#include <tuple>

#include "benchmarks/result_table.h"
#include "runtime/mission_end.h"

namespace prospect {
namespace {

using Number = double ComparisonRow::*;

constexpr std::array<std::pair<const char*, Number>, 20> kNumbers = {{
    {"coverage", &ComparisonRow::coverage},
    {"reachable_area_m2", &ComparisonRow::reachable_area_m2},
    {"duration_s", &ComparisonRow::duration_s},
    {"path_length_m", &ComparisonRow::path_length_m},
    {"time_to_90_s", &ComparisonRow::time_to_90_s},
    {"time_to_95_s", &ComparisonRow::time_to_95_s},
    {"time_to_99_s", &ComparisonRow::time_to_99_s},
    {"path_to_90_m", &ComparisonRow::path_to_90_m},
    {"path_to_95_m", &ComparisonRow::path_to_95_m},
    {"path_to_99_m", &ComparisonRow::path_to_99_m},
    {"collisions", &ComparisonRow::collisions},
    {"losses", &ComparisonRow::losses},
    {"localization_rmse_m", &ComparisonRow::localization_rmse_m},
    {"localization_final_m", &ComparisonRow::localization_final_m},
    {"plan_ms_p50", &ComparisonRow::plan_ms_p50},
    {"plan_ms_p95", &ComparisonRow::plan_ms_p95},
    {"fallbacks", &ComparisonRow::fallbacks},
    {"guard_stops", &ComparisonRow::guard_stops},
    {"steps", &ComparisonRow::steps},
    {"wall_s", &ComparisonRow::wall_s},
}};

std::string format(const char* pattern, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), pattern, value);
  return buffer.data();
}

/// Mean of the finite values, and how many there are.
struct Mean {
  double sum = 0.0;
  int count = 0;
  void add(double value) {
    if (!std::isfinite(value)) return;
    sum += value;
    ++count;
  }
  double value() const { return sum / count; }
};

/// Planners and maps in the order in which they first occur.
std::vector<std::string> distinct(const std::vector<ComparisonRow>& rows,
                                  std::string ComparisonRow::*name) {
  std::vector<std::string> names;
  for (const ComparisonRow& row : rows) {
    if (std::find(names.begin(), names.end(), row.*name) == names.end()) {
      names.push_back(row.*name);
    }
  }
  return names;
}

/// "253", "253 (2/3)" where 2 of 3 missions have the number, "- (0/3)".
std::string cell(const std::vector<const ComparisonRow*>& rows, Number number,
                 const char* pattern = "%.0f") {
  Mean mean;
  for (const ComparisonRow* row : rows) mean.add(row->*number);
  const int all = static_cast<int>(rows.size());
  std::string s = mean.count > 0 ? format(pattern, mean.value()) : "-";
  if (mean.count < all) s += " (" + std::to_string(mean.count) + "/" + std::to_string(all) + ")";
  return s;
}

std::string sum(const std::vector<const ComparisonRow*>& rows, Number number) {
  double total = 0.0;
  for (const ComparisonRow* row : rows) total += std::isfinite(row->*number) ? row->*number : 0.0;
  return format("%.0f", total);
}

/// Ratios of a number between two planners, over the missions (map, seed) of both.
struct Pairs {
  Mean log_ratio;
  int only_first = 0, only_second = 0, neither = 0;
  double ratio() const { return std::exp(log_ratio.value()); }
  void add(double first, double second) {
    const bool a = std::isfinite(first) && first > 0.0, b = std::isfinite(second) && second > 0.0;
    if (a && b) log_ratio.add(std::log(first / second));
    only_first += a && !b;
    only_second += !a && b;
    neither += !a && !b;
  }
};

using RowsByKey =
    std::map<std::tuple<std::string, std::string, std::uint64_t>, const ComparisonRow*>;

void tell_means(const RowsByKey& by_key, const std::vector<std::string>& maps,
                const std::vector<std::string>& planners, std::ostream& out) {
  out << "Means over the seeds. In brackets: how many missions reached that level, where not all "
         "did; the mean is over those. Collisions, losses of localization and fallbacks: sums.\n\n"
      << "| map (m2) | planner | missions | coverage % | time to 90 / 95 / 99 % [s] | path to 90 / "
         "95 / 99 % [m] | end [s] | collisions | losses | error RMS / final [m] | replanning p50 / "
         "p95 [ms] | fallbacks |\n"
      << "|-|-|-|-|-|-|-|-|-|-|-|-|\n";
  for (const std::string& map : maps) {
    for (const std::string& planner : planners) {
      std::vector<const ComparisonRow*> group;
      for (const auto& [key, row] : by_key) {
        if (std::get<0>(key) == map && std::get<1>(key) == planner) group.push_back(row);
      }
      if (group.empty()) continue;
      Mean area, coverage;
      int failed = 0;
      for (const ComparisonRow* row : group) {
        area.add(row->reachable_area_m2);
        coverage.add(100.0 * row->coverage);
        failed += row->failed();
      }
      out << "| " << map << (area.count > 0 ? format(" (%.0f)", area.value()) : "") << " | "
          << planner << " | " << group.size();
      if (failed > 0) out << ", " << failed << " failed";
      out << " | " << (coverage.count > 0 ? format("%.1f", coverage.value()) : "-") << " | "
          << cell(group, &ComparisonRow::time_to_90_s) << " / "
          << cell(group, &ComparisonRow::time_to_95_s) << " / "
          << cell(group, &ComparisonRow::time_to_99_s) << " | "
          << cell(group, &ComparisonRow::path_to_90_m) << " / "
          << cell(group, &ComparisonRow::path_to_95_m) << " / "
          << cell(group, &ComparisonRow::path_to_99_m) << " | "
          << cell(group, &ComparisonRow::duration_s) << " | "
          << sum(group, &ComparisonRow::collisions) << " | " << sum(group, &ComparisonRow::losses)
          << " | " << cell(group, &ComparisonRow::localization_rmse_m, "%.2f") << " / "
          << cell(group, &ComparisonRow::localization_final_m, "%.2f") << " | "
          << cell(group, &ComparisonRow::plan_ms_p50, "%.1f") << " / "
          << cell(group, &ComparisonRow::plan_ms_p95, "%.1f") << " | "
          << sum(group, &ComparisonRow::fallbacks) << " |\n";
    }
  }
}

void tell_pairs(const RowsByKey& by_key, const std::vector<std::string>& maps,
                const std::string& reference, const std::string& other, std::ostream& out) {
  const std::vector<std::pair<const char*, Number>> levels = {
      {"time to 90 %", &ComparisonRow::time_to_90_s},
      {"time to 95 %", &ComparisonRow::time_to_95_s},
      {"time to 99 %", &ComparisonRow::time_to_99_s},
      {"path to 90 %", &ComparisonRow::path_to_90_m},
      {"path to 95 %", &ComparisonRow::path_to_95_m},
      {"path to 99 %", &ComparisonRow::path_to_99_m},
  };
  out << "\n"
      << reference << " against " << other
      << ", paired by map and seed: geometric mean of the ratio over pairs that both reached the "
         "level (below 1: "
      << reference << " is better), by map; won / lost counts maps by their ratio.\n\n"
      << "| | ratio | pairs | maps won / lost | 20 % less on | only " << reference << " / only "
      << other << " / neither |\n|-|-|-|-|-|-|\n";
  for (const auto& [name, number] : levels) {
    Pairs all;
    Mean over_maps;
    int won = 0, lost = 0, clearly = 0;
    for (const std::string& map : maps) {
      Pairs of_map;
      for (const auto& [key, row] : by_key) {
        if (std::get<0>(key) != map || std::get<1>(key) != reference) continue;
        const auto partner = by_key.find({map, other, std::get<2>(key)});
        if (partner == by_key.end()) continue;
        all.add(row->*number, partner->second->*number);
        of_map.add(row->*number, partner->second->*number);
      }
      if (of_map.log_ratio.count == 0) continue;
      over_maps.add(of_map.log_ratio.value());
      won += of_map.ratio() < 1.0;
      lost += of_map.ratio() > 1.0;
      clearly += of_map.ratio() <= 0.8;
    }
    out << "| " << name << " | "
        << (over_maps.count > 0 ? format("%.2f", std::exp(over_maps.value())) : "-") << " | "
        << all.log_ratio.count << " | " << won << " / " << lost << " | " << clearly << " | "
        << all.only_first << " / " << all.only_second << " / " << all.neither << " |\n";
  }
  out << "\n| map | time to 95 %: ratio by seed | mean |\n|-|-|-|\n";
  for (const std::string& map : maps) {
    Pairs of_map;
    std::string ratios;
    for (const auto& [key, row] : by_key) {
      if (std::get<0>(key) != map || std::get<1>(key) != reference) continue;
      const auto partner = by_key.find({map, other, std::get<2>(key)});
      if (partner == by_key.end()) continue;
      const double a = row->time_to_95_s, b = partner->second->time_to_95_s;
      of_map.add(a, b);
      if (!ratios.empty()) ratios += ", ";
      ratios += std::isfinite(a) && std::isfinite(b) ? format("%.2f", a / b)
                : std::isfinite(a)                   ? "only " + reference
                : std::isfinite(b)                   ? "only " + other
                                                     : "neither";
    }
    if (ratios.empty()) continue;
    out << "| " << map << " | " << ratios << " | "
        << (of_map.log_ratio.count > 0 ? format("%.2f", of_map.ratio()) : "-") << " |\n";
  }
}

void tell_failures(const std::vector<ComparisonRow>& rows, std::ostream& out) {
  bool first = true;
  for (const ComparisonRow& row : rows) {
    const std::optional<MissionEnd> end = mission_end_named(row.reason);
    const bool ended_well = end && row_of(*end).outcome == Outcome::kDone;
    if (!row.failed() && ended_well && row.collisions == 0.0 && std::isfinite(row.time_to_95_s)) {
      continue;
    }
    if (first)
      out << "\nMissions that failed, hit something, ended early or stayed below 95 %:\n\n";
    first = false;
    out << "- " << row.map << ", " << row.planner << ", seed " << row.seed << ": " << row.reason;
    if (std::isfinite(row.coverage)) out << format(", coverage %.1f %%", 100.0 * row.coverage);
    if (row.collisions > 0.0) out << format(", %.0f collisions", row.collisions);
    out << '\n';
  }
}

}  // namespace

ComparisonRow comparison_row(const std::string& map, const std::string& planner, const Summary& s) {
  ComparisonRow row;
  row.map = map;
  row.planner = planner;
  row.seed = s.seed;
  row.reason = to_string(s.end);
  row.coverage = s.coverage;
  row.reachable_area_m2 = s.reachable_area_m2;
  row.duration_s = s.duration_s;
  row.path_length_m = s.path_length_m;
  row.time_to_90_s = s.time_to_90_s;
  row.time_to_95_s = s.time_to_95_s;
  row.time_to_99_s = s.time_to_99_s;
  row.path_to_90_m = s.path_to_90_m;
  row.path_to_95_m = s.path_to_95_m;
  row.path_to_99_m = s.path_to_99_m;
  row.collisions = s.collisions;
  row.losses = s.losses;
  row.localization_rmse_m = s.localization_rmse_m;
  row.localization_final_m = s.localization_final_m;
  row.plan_ms_p50 = s.plan_ms_p50;
  row.plan_ms_p95 = s.plan_ms_p95;
  row.fallbacks = s.fallbacks;
  row.guard_stops = s.guard_stops;
  row.steps = s.steps;
  row.wall_s = s.wall_s;
  return row;
}

std::string comparison_header() {
  std::string header = "map,planner,seed,reason";
  for (const auto& [name, number] : kNumbers) {
    header += std::string(",") + name;
  }
  return header;
}

std::string comparison_line(const ComparisonRow& row) {
  std::string line = table_text(row.map) + ',' + table_text(row.planner) + ',' +
                     std::to_string(row.seed) + ',' + table_text(row.reason);
  for (const auto& [name, number] : kNumbers) {
    line += ',' + table_number(row.*number);
  }
  return line;
}

std::vector<ComparisonRow> read_comparison(const std::string& path) {
  std::vector<ComparisonRow> rows;
  for (const TableLine& line : read_table(path, comparison_header())) {
    ComparisonRow row;
    row.map = line.fields[0];
    row.planner = line.fields[1];
    row.seed = read_seed(path, line, 2);
    row.reason = line.fields[3];
    std::size_t at = 4;
    for (const auto& [name, number] : kNumbers) row.*number = read_number(path, line, at++, name);
    rows.push_back(std::move(row));
  }
  return rows;
}

void append_comparison(const std::string& path, const ComparisonRow& row) {
  append_to_table(path, comparison_header(), comparison_line(row));
}

std::string comparison_report(const std::vector<ComparisonRow>& rows,
                              const std::string& reference) {
  const std::vector<std::string> maps = distinct(rows, &ComparisonRow::map);
  std::vector<std::string> planners = distinct(rows, &ComparisonRow::planner);
  std::stable_partition(planners.begin(), planners.end(),
                        [&](const std::string& planner) { return planner == reference; });
  RowsByKey by_key;
  for (const ComparisonRow& row : rows) by_key[{row.map, row.planner, row.seed}] = &row;
  std::ostringstream out;
  tell_means(by_key, maps, planners, out);
  for (const std::string& other : planners) {
    if (other != reference) tell_pairs(by_key, maps, reference, other, out);
  }
  tell_failures(rows, out);
  return out.str();
}

}  // namespace prospect
