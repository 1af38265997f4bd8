// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

namespace prospect {

/// Reads the whole of `text` as a number, in any locale; false, and `number` as it was, if it is
/// none.
template <typename Number>
bool parse_number(std::string_view text, Number& number) {
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, number);
  return error == std::errc() && end == last;
}

}  // namespace prospect
