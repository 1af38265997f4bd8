// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "adapters/formats/files/output_folder.h"
#include "adapters/missions/bench/bench_summary.h"
#include "adapters/missions/bench/bench_table.h"

namespace prospect {

/// One row a cell, docs/reference/bench.md names the columns. An empty field: there is no such
/// number.
std::string bench_csv(const BenchTable& table);

/// Everything: problems with their best known costs, rows, summaries with profiles and curves, and
/// what measured. `traces`: with the solution of every row and its improvements, less those that
/// gain under a twentieth of what was still to gain.
nlohmann::ordered_json bench_json(const BenchTable& table, const std::vector<GroupSummary>& groups,
                                  bool traces);

/// The table of one group for a terminal.
std::string bench_text(const BenchTable& table, const GroupSummary& group);

/// What becomes of the rows that the folder of a bench holds.
enum class EarlierRows {
  kRefused,  ///< they are not to be lost
  kKept,     ///< the bench goes on with them
  kReplaced  ///< they are written over
};
/// The folder of a bench. Throws InputError, before anything is measured or changed, if it is none
/// of a bench (OutputFolder::own()), or holds rows and they are not to be lost.
OutputFolder open_bench_folder(const std::string& path, EarlierRows earlier);

/// Begins a bench: of an earlier one the rows are left, until new ones are there.
void begin_bench_folder(OutputFolder& folder);

/// A row for each back end in each group: counts, medians, and what has an interval.
std::string summary_csv(const std::vector<GroupSummary>& groups);

/// Writes to the folder figures/ (every curve as SVG, bench_curves.h), planner_arena/
/// (planner_arena_log.h), curves.csv, summary.csv, bench.csv, bench.html and bench.json, each whole
/// or not at all, bench.json last, and marks it as complete unless the table is cancelled. Throws
/// std::runtime_error.
void write_bench_folder(OutputFolder& folder, const BenchTable& table,
                        const std::vector<GroupSummary>& groups);

}  // namespace prospect
