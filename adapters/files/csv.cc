#include "adapters/files/csv.h"

#include <charconv>
#include <cmath>

namespace prospect::csv {

std::string text(double value) {
  if (std::isnan(value)) return "nan";  // without the sign that a NaN may carry
  char buffer[64];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string field(const std::string& value) {
  if (value.find_first_of(",\"\n\r") == std::string::npos) return value;
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' || c == '\r' ? ' ' : c;
  }
  return quoted + '"';
}

}  // namespace prospect::csv
