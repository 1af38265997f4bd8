// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace prospect {

/// steps.csv of a run folder (docs/reference/report.md), its columns found by name, so that runs of
/// older and newer programs can be read as far as their columns go.
class StepTable {
 public:
  /// Reads the whole file. Throws InputError, one line `file:line: what; expected what`: no such
  /// file, no header, a row of another length than the header, a last row that is cut.
  static StepTable read(const std::string& path);
  /// The same from text; `source` stands for the file's name in messages.
  static StepTable parse(const std::string& text, const std::string& source);

  std::size_t rows() const { return rows_.size(); }
  bool has(const std::string& column) const;
  /// All of them, in their order.
  const std::vector<std::string>& columns() const { return header_; }
  /// "FILE:LINE" of a row from 0, for messages.
  std::string row_name(std::size_t row) const { return source_ + ":" + std::to_string(row + 2); }
  /// Each row's number; NaN where the field is empty or "nan". Throws InputError if there is no
  /// such column or a field holds anything else.
  std::vector<double> numbers(const std::string& column) const;
  /// Each row's text. Throws InputError if there is no such column.
  std::vector<std::string> words(const std::string& column) const;

 private:
  std::size_t index(const std::string& column) const;

  std::string source_;
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace prospect
