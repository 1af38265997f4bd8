// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace prospect {

/// What this program was built by and with. The build writes the definitions
/// (cmake/BuildVersions.cmake).
std::string_view compiler();        ///< "GNU 12.2.0"
std::string_view compiler_flags();  ///< less those for warnings
std::string_view build_type();

struct BuiltWith {
  const char* name;
  const char* version;  ///< as CMake or pkg-config found it
  const char* file;     ///< with which the name of its shared library begins; "": headers only
};
/// Of the libraries that were found, in the order of what builds on what.
std::span<const BuiltWith> libraries_built_with();

}  // namespace prospect
