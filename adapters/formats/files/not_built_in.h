// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace prospect {

/// A component whose library was absent when the program was built: its interface is there and says
/// so when it is used (exit code 3).
class NotBuiltIn : public std::runtime_error {
 public:
  NotBuiltIn(const std::string& component, const std::string& needs)
      : std::runtime_error(component + " is not built in; it needs " + needs) {}
};

}  // namespace prospect
