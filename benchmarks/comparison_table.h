// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "adapters/missions/run/run_record.h"

namespace prospect {

/// One mission of the comparison. NaN: never reached, or no such number.
struct ComparisonRow {
  std::string map, planner;
  std::uint64_t seed = 0;
  std::string reason;  ///< why the mission ended; "failed: ..." if it could not be run to an end
  double coverage = std::numeric_limits<double>::quiet_NaN();
  double reachable_area_m2 = std::numeric_limits<double>::quiet_NaN();
  double duration_s = std::numeric_limits<double>::quiet_NaN();
  double path_length_m = std::numeric_limits<double>::quiet_NaN();
  double time_to_90_s = std::numeric_limits<double>::quiet_NaN();
  double time_to_95_s = std::numeric_limits<double>::quiet_NaN();
  double time_to_99_s = std::numeric_limits<double>::quiet_NaN();
  double path_to_90_m = std::numeric_limits<double>::quiet_NaN();
  double path_to_95_m = std::numeric_limits<double>::quiet_NaN();
  double path_to_99_m = std::numeric_limits<double>::quiet_NaN();
  double collisions = std::numeric_limits<double>::quiet_NaN();
  double losses = std::numeric_limits<double>::quiet_NaN();
  double localization_rmse_m = std::numeric_limits<double>::quiet_NaN();
  double localization_final_m = std::numeric_limits<double>::quiet_NaN();
  double plan_ms_p50 = std::numeric_limits<double>::quiet_NaN();
  double plan_ms_p95 = std::numeric_limits<double>::quiet_NaN();
  double fallbacks = std::numeric_limits<double>::quiet_NaN();
  double guard_stops = std::numeric_limits<double>::quiet_NaN();
  double steps = std::numeric_limits<double>::quiet_NaN();
  double wall_s = std::numeric_limits<double>::quiet_NaN();

  bool failed() const { return reason.rfind("failed", 0) == 0; }
};

ComparisonRow comparison_row(const std::string& map, const std::string& planner,
                             const Summary& summary);

/// As a table of result_table.h. Commas and line ends in texts become blanks.
std::string comparison_header();
std::string comparison_line(const ComparisonRow& row);

/// The rows of a file; none if it does not exist. A last line without its end (the writer was
/// killed) is left out. Throws InputError for a file that is not such a table.
std::vector<ComparisonRow> read_comparison(const std::string& path);

/// append_to_table(). Throws InputError.
void append_comparison(const std::string& path, const ComparisonRow& row);

/// Markdown: means over the seeds by map and planner, each with the number of missions that reached
/// the level where not all did; then `reference` against each other planner, paired by map and
/// seed. Missions that failed or did not reach a level are counted, not dropped silently.
std::string comparison_report(const std::vector<ComparisonRow>& rows,
                              const std::string& reference = "mpc");

}  // namespace prospect
