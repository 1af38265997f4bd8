// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace prospect {

/// Tables of comma-separated values to which several processes append a row a mission: a header,
/// then one line a row; empty entries are NaN; no quotes, texts hold neither commas nor line ends.
struct TableLine {
  int number = 0;  ///< of the line in the file, from 1
  std::vector<std::string> fields;
};

/// The lines of a file below its header; none if it does not exist. A last line without its end
/// (the writer was killed) is left out. Throws InputError for a file with another header, or a line
/// with another number of entries than it.
std::vector<TableLine> read_table(const std::string& path, const std::string& header);

/// Appends a line, and the header if the file is empty, in one write under a file lock: processes
/// may append to one file, and a row that was written survives a kill. Throws InputError.
void append_to_table(const std::string& path, const std::string& header, const std::string& line);

/// Commas and line ends become blanks.
std::string table_text(std::string text);

/// Six digits; "" for a number that is not finite.
std::string table_number(double value);

/// The number in an entry of that name: NaN if it is empty. Throws InputError (path:line: ...).
double read_number(const std::string& path, const TableLine& line, std::size_t field,
                   const std::string& name);

/// The same for a seed, which must not be empty.
std::uint64_t read_seed(const std::string& path, const TableLine& line, std::size_t field);

}  // namespace prospect
