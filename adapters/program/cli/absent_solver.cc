#include "adapters/program/cli/absent_solver.h"

#include <iostream>

namespace prospect {

bool tell_if_absent(const std::string& solver, const SolverRegistry& registry) {
  for (const SolverInfo& info : registry.list()) {
    if (info.name != solver || info.available) continue;
    std::cerr << "prospect: " << info.name << " is not built in; it needs " << info.needs << '\n';
    return true;
  }
  return false;
}

}  // namespace prospect
