#pragma once

#include <span>
#include <string_view>

namespace prospect {

/// What a build may lack, because a library was absent.
struct Adapter {
  std::string_view name;
  std::string_view description;
  std::string_view needs;    ///< packages of Debian, separated by spaces
  std::string_view missing;  ///< of them those that the build did not find; "": it is built in
  bool built_in() const { return missing.empty(); }
};
/// The build writes the definition (cmake/Adapters.cmake, which holds the table).
std::span<const Adapter> adapters();

}  // namespace prospect
