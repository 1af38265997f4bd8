#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "adapters/bench/bench_run.h"
#include "adapters/bench/bench_summary.h"

namespace prospect {

/// One row a cell, docs/reference/bench.md names the columns. An empty field: there is no such
/// number.
std::string bench_csv(const BenchTable& table);

/// Everything: problems with their best known costs, rows, summaries with profiles and curves.
/// `traces`: with the improvements of every row, less those that gain under a twentieth of what was
/// still to gain.
nlohmann::ordered_json bench_json(const BenchTable& table, const std::vector<GroupSummary>& groups,
                                  bool traces);

/// The table of one group for a terminal.
std::string bench_text(const BenchTable& table, const GroupSummary& group);

/// The folder that bench.csv, bench.json and bench.html go to: made if it is not there. Throws
/// InputError, before anything is measured, if it is a file, cannot be made, or holds something but
/// no earlier bench.json.
void open_bench_folder(const std::string& path);

/// Writes the three files, each whole or not at all, bench.json last. Throws std::runtime_error.
void write_bench_folder(const std::string& path, const BenchTable& table,
                        const std::vector<GroupSummary>& groups);

}  // namespace prospect
