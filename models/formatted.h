// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>

namespace prospect {

/// std::snprintf into a string, for sentences with numbers; cut after 255 characters.
template <typename... Args>
std::string formatted(const char* pattern, Args... args) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, args...);
  return text;
}

}  // namespace prospect
