#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/solver.h"

namespace prospect {

/// One line of `prospect list solvers`.
struct SolverInfo {
  std::string name;         ///< as make_solver() takes it
  std::string description;  ///< one sentence
  std::vector<OptionInfo> options;
  bool available = true;  ///< false: its library was absent when this program was built
  std::string needs;      ///< the library it needs; empty for none
};

/// The back end of that name: "ipopt"; "nlopt" or "nlopt:ALGORITHM"; "sampling", "sampling:mppi" or
/// "sampling:search". A back end whose library is absent is returned all the same: its
/// explain_unsupported() and the kError of its solve() say what is missing.
///
/// Throws std::invalid_argument, with the nearest valid name, if there is no such back end.
/// Thread-safety: may be called from any thread; the solvers returned are immutable.
std::shared_ptr<const Solver> make_solver(std::string_view name);

/// All names make_solver() takes, in alphabetical order.
std::vector<SolverInfo> list_solvers();

}  // namespace prospect
