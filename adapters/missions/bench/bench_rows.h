// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/files/row_file.h"
#include "adapters/missions/bench/bench_table.h"

namespace prospect {

/// Name of the file of a bench's rows in its folder.
inline constexpr const char* kBenchRows = "rows.jsonl";
/// What becomes that file as soon as it holds all that the folder held before.
inline constexpr const char* kBenchRowsPart = "rows.jsonl.part";

/// What is measured, on disk as it comes: rows.jsonl, a JSON object a line.
///
///   {"bench": {...}}    first: sets and problems, back ends, deadlines, seeds, repeats, ...
///   {"environment": {...}}    what measured the rows after it; one for each run
///   {"row": {...}}    one cell with its solution and every improvement, all digits
///
/// Whoever kills the program finds whole rows (row_file.h). The tables of a bench are made from
/// this file alone. Not thread-safe.
class BenchRowFile {
 public:
  /// Begins the file of a folder with what the table holds; a file that is there stays as it is
  /// until the new one holds all of it. Throws std::runtime_error if it cannot be written.
  BenchRowFile(const std::string& folder, const BenchTable& table);
  /// A row of that table. Throws std::runtime_error.
  void append(const BenchTable& table, const BenchRow& row);

 private:
  std::string path_;
  RowFile file_;
  int environment_ = -1;  // of the last row
};

/// The rows of the bench in a folder; not yet judged, in the order of the file. A last line that is
/// cut off is left out. Throws InputError in one line that names the file and the line.
BenchTable read_bench_rows(const std::string& folder);

/// Why the rows of `earlier` cannot be part of `wanted`, which may have more back ends, deadlines,
/// seeds and problems; "" if they can. They must be of the same build of the program, the same
/// problems by name and fingerprint, and of as many repeats and evaluations.
std::string differs_from(const BenchTable& earlier, const BenchTable& wanted);

/// Adds the rows and environments of `from` to `to`, which must have its sets, problems, back ends,
/// deadlines and seeds. Returns "", or the words of a row that both have; then `to` is as it was.
std::string take_rows(BenchTable& to, const BenchTable& from);

}  // namespace prospect
