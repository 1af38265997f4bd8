// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// Names in a file, a path, or what a driver says may hold anything; a message is one line: control
/// characters (C0 and DEL) become spaces.
inline std::string one_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return text;
}

}  // namespace prospect
