// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace prospect {

/// What a build may lack, because a library was absent or a target was not built.
struct Adapter {
  std::string_view name;
  std::string_view description;
  std::string_view needs;    ///< packages of Debian, separated by spaces
  std::string_view missing;  ///< of them those that the build did not find
  std::string_view
      modules;  ///< of the Python package, separated by spaces; "": it is in the program
};
/// The build writes the definitions (cmake/Adapters.cmake, which holds the table).
std::span<const Adapter> adapters();
/// The folder below the prefix of an installation whose dist-packages or site-packages have them.
std::string_view python_library();

/// What it takes until the adapter is there, "": it is. Of modules the files are looked for: beside
/// this code where that is one of them, else where the program's build or installation has them.
std::string lacks(const Adapter& adapter);

}  // namespace prospect
