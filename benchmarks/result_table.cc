// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/result_table.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  if (!line.empty() && line.back() == ',') fields.emplace_back();
  return fields;
}

[[noreturn]] void refuse(const std::string& path, int line, const std::string& what) {
  throw InputError(path + ":" + std::to_string(line) + ": " + what);
}

}  // namespace

std::vector<TableLine> read_table(const std::string& path, const std::string& header) {
  std::vector<TableLine> lines;
  std::ifstream file(path);
  if (!file) return lines;
  std::ostringstream content;
  content << file.rdbuf();
  const std::string all = content.str();
  const std::size_t expected = split(header).size();
  std::size_t begin = 0;
  for (int number = 1; begin < all.size(); ++number) {
    const std::size_t end = all.find('\n', begin);
    if (end == std::string::npos) break;
    const std::string line = all.substr(begin, end - begin);
    begin = end + 1;
    if (number == 1) {
      if (line == header) continue;
      refuse(path, 1, "not a table of this comparison; expected the header " + header);
    }
    std::vector<std::string> fields = split(line);
    if (fields.size() != expected) {
      refuse(path, number,
             std::to_string(fields.size()) + " entries; expected " + std::to_string(expected));
    }
    lines.push_back({number, std::move(fields)});
  }
  return lines;
}

void append_to_table(const std::string& path, const std::string& header, const std::string& line) {
  const auto give_up = [&](const char* what) {
    throw InputError(path + ": " + what + ": " + std::strerror(errno));
  };
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) give_up("cannot be opened for writing");
  std::string text;
  bool written = ::flock(file, LOCK_EX) == 0;
  const off_t size = ::lseek(file, 0, SEEK_END);
  if (size == 0) text = header + '\n';
  if (size > 0) {
    // A line that a killed writer left unfinished must not swallow this one.
    char last = '\n';
    if (::pread(file, &last, 1, size - 1) == 1 && last != '\n') {
      off_t end = size;
      while (end > 0 && ::pread(file, &last, 1, end - 1) == 1 && last != '\n') --end;
      written = ::ftruncate(file, end) == 0 && written;
    }
  }
  text += line + '\n';
  written = written && ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (!written) {
    ::close(file);
    give_up("cannot be written");
  }
  ::close(file);
}

std::string table_text(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string table_number(double value) {
  if (!std::isfinite(value)) return "";
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.6g", value);
  return buffer.data();
}

double read_number(const std::string& path, const TableLine& line, std::size_t field,
                   const std::string& name) {
  const std::string& text = line.fields[field];
  if (text.empty()) return std::numeric_limits<double>::quiet_NaN();
  char* rest = nullptr;
  const double value = std::strtod(text.c_str(), &rest);
  if (*rest != '\0') refuse(path, line.number, name + " '" + text + "'; expected a number");
  return value;
}

std::uint64_t read_seed(const std::string& path, const TableLine& line, std::size_t field) {
  const std::string& text = line.fields[field];
  char* rest = nullptr;
  const std::uint64_t seed = std::strtoull(text.c_str(), &rest, 10);
  if (text.empty() || *rest != '\0') {
    refuse(path, line.number, "seed '" + text + "'; expected a number");
  }
  return seed;
}

}  // namespace prospect
