// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace prospect {

struct LibraryVersion {
  std::string name;
  std::string built_with;  ///< version; "" if that is not known
  /// File name of the shared library that is loaded, with its own number: "libceres.so.2.1.0"; ""
  /// of libraries that are headers only or linked in.
  std::string runs_with;
};

/// What this program is: enough to build it again. Holds nothing of a machine: no host, no path.
struct BuildInfo {
  std::string version;
  std::string commit;           ///< in full; "" if it was built without git
  bool commit_changed = false;  ///< files that git knows differed from the commit
  std::string compiler;         ///< "GNU 12.2.0"
  std::string flags;            ///< of the compiler, less those for warnings
  std::string build_type;
  /// Of those built in: in the order of what builds on what. The last is the BLAS that is loaded,
  /// if one is: the last bits of Ipopt and Ceres depend on it.
  std::vector<LibraryVersion> libraries;
};

BuildInfo build_info();
nlohmann::ordered_json to_json(const BuildInfo& info);
/// Some lines, the first of which is "prospect VERSION".
std::string to_text(const BuildInfo& info);

/// Model of the processor that this program runs on, as the operating system names it; "" if it
/// does not.
std::string processor_name();

}  // namespace prospect
