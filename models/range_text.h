// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace prospect {

/// The shortest text that reads back as the number; "nan", "inf", "-inf".
inline std::string exact_text(double value) {
  if (!std::isfinite(value)) return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}
inline std::string exact_text(int value) { return std::to_string(value); }
inline std::string exact_text(std::int64_t value) { return std::to_string(value); }

/// "0 to 5", "0 or more", "5 or less", ""; the largest and the least number of the type stand for
/// no end.
template <typename T>
std::string range_text(T min, T max) {
  const bool low = min > std::numeric_limits<T>::lowest();
  const bool high = max < std::numeric_limits<T>::max();
  if (low && high) return exact_text(min) + " to " + exact_text(max);
  if (low) return exact_text(min) + " or more";
  return high ? exact_text(max) + " or less" : "";
}

/// What follows "a number" in a message: " from 0 to 5 m", " of at least 0 m", "".
template <typename T>
std::string in_range(T min, T max, const std::string& unit) {
  const std::string suffix = unit.empty() || unit == "1" ? "" : " " + unit;
  const bool low = min > std::numeric_limits<T>::lowest();
  const bool high = max < std::numeric_limits<T>::max();
  if (low && high) return " from " + exact_text(min) + " to " + exact_text(max) + suffix;
  if (low) return " of at least " + exact_text(min) + suffix;
  if (high) return " of at most " + exact_text(max) + suffix;
  return suffix.empty() ? "" : " in" + suffix;
}

}  // namespace prospect
