// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace prospect {

// Enumerations by their names: those whose enumerators are 0, 1, 2, ... and for which to_string()
// gives "?" past the last.

/// The names of all enumerators, in their order.
template <class Enum>
std::vector<std::string_view> names_of() {
  std::vector<std::string_view> names;
  for (int i = 0; to_string(static_cast<Enum>(i)) != "?"; ++i) {
    names.push_back(to_string(static_cast<Enum>(i)));
  }
  return names;
}

/// The enumerator of that name; none: there is no such one.
template <class Enum>
std::optional<Enum> named(std::string_view name) {
  for (int i = 0; to_string(static_cast<Enum>(i)) != "?"; ++i) {
    if (to_string(static_cast<Enum>(i)) == name) return static_cast<Enum>(i);
  }
  return std::nullopt;
}

/// "" for none.
template <class Enum>
std::string name_of(std::optional<Enum> value) {
  return value ? std::string(to_string(*value)) : "";
}

}  // namespace prospect
