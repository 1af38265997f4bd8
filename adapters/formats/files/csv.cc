// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/csv.h"

namespace prospect::csv {

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
