// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/absent_solver.h"

#include <algorithm>
#include <iostream>
#include <vector>

namespace prospect {

bool is_absent(const std::string& solver, const SolverRegistry& registry) {
  const std::vector<SolverInfo> known = registry.list();
  return std::any_of(known.begin(), known.end(), [&](const SolverInfo& info) {
    return info.name == solver && !info.available;
  });
}

bool tell_if_absent(const std::string& solver, const SolverRegistry& registry) {
  for (const SolverInfo& info : registry.list()) {
    if (info.name != solver || info.available) continue;
    std::cerr << "prospect: " << info.name << " is not built in; it needs " << info.needs << '\n';
    return true;
  }
  return false;
}

}  // namespace prospect
