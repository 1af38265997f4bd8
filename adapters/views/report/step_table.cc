// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/step_table.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"

namespace prospect {
namespace {

/// The fields of a row (RFC 4180; a field holds no line break, see csv::field()). False: a quote is
/// not closed, or something follows one that is.
bool split_row(const std::string& row, std::vector<std::string>& fields) {
  fields.assign(1, "");
  for (std::size_t i = 0; i < row.size();) {
    if (row[i] == '"' && fields.back().empty()) {
      for (++i;; ++i) {
        if (i >= row.size()) return false;
        if (row[i] != '"') {
          fields.back() += row[i];
        } else if (i + 1 < row.size() && row[i + 1] == '"') {
          fields.back() += row[i++];
        } else {
          break;
        }
      }
      if (++i < row.size() && row[i] != ',') return false;
    }
    if (i >= row.size()) break;
    if (row[i] == ',') {
      fields.emplace_back();
    } else {
      fields.back() += row[i];
    }
    ++i;
  }
  return true;
}

}  // namespace

StepTable StepTable::read(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    fail(path, "no such file; expected the steps of a run");
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    fail(path, "is no file; expected the steps of a run");
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) fail(path, "cannot be read; expected the steps of a run");
  return parse(text.str(), path);
}

StepTable StepTable::parse(const std::string& text, const std::string& source) {
  StepTable table;
  table.source_ = source;
  std::vector<std::string> fields;
  std::size_t line = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::string where = source + ":" + std::to_string(++line);
    if (end == std::string::npos) fail(where, "the row is cut; expected the end of a line");
    if (!split_row(text.substr(at, end - at), fields)) {
      fail(where, "a quote without its other; expected fields as in RFC 4180");
    }
    at = end + 1;
    if (line == 1) {
      table.header_ = fields;
      if (!table.has("step")) fail(where, "no column 'step'; expected the steps of a run");
      continue;
    }
    if (fields.size() != table.header_.size()) {
      fail(where, std::to_string(fields.size()) + " fields; expected " +
                      std::to_string(table.header_.size()) + ", as in the header");
    }
    table.rows_.push_back(fields);
  }
  if (line == 0) fail(source, "empty file; expected the steps of a run");
  return table;
}

bool StepTable::has(const std::string& column) const {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::size_t StepTable::index(const std::string& column) const {
  if (!has(column)) {
    fail(source_, "no column '" + column + "'; expected one, as newer programs write it");
  }
  return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), column) -
                                  header_.begin());
}

std::vector<double> StepTable::numbers(const std::string& column) const {
  const std::size_t at = index(column);
  std::vector<double> values;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const std::string& field = rows_[k][at];
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!field.empty() && !parse_number(field, value)) {
      fail(row_name(k), column + " is '" + field + "'; expected a number");
    }
    values.push_back(value);
  }
  return values;
}

std::vector<std::string> StepTable::words(const std::string& column) const {
  const std::size_t at = index(column);
  std::vector<std::string> values;
  for (const std::vector<std::string>& row : rows_) values.push_back(row[at]);
  return values;
}

}  // namespace prospect
