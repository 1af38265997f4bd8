#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "adapters/bench/bench_summary.h"
#include "adapters/bench/bench_table.h"

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

/// The folder of a bench: made if it is not there. Throws InputError, before anything is measured,
/// if it is a file, cannot be made, or holds something but no bench; unless `resume`, also if it
/// holds one that was broken off before its files were written.
void open_bench_folder(const std::string& path, bool resume);

/// Removes what write_bench_folder() has written to the folder, and nothing else.
void clear_bench_folder(const std::string& path);

/// A row for each back end in each group: counts, medians, and what has an interval.
std::string summary_csv(const std::vector<GroupSummary>& groups);

/// Writes figures/ (every curve as SVG, bench_curves.h), planner_arena/ (planner_arena_log.h),
/// curves.csv, summary.csv, bench.csv, bench.html and bench.json, each whole or not at all,
/// bench.json last. Throws std::runtime_error.
void write_bench_folder(const std::string& path, const BenchTable& table,
                        const std::vector<GroupSummary>& groups);

}  // namespace prospect
