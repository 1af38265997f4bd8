// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/problem/solver.h"

namespace prospect {

/// One line of `prospect list solvers`.
struct SolverInfo {
  std::string name;         ///< as SolverRegistry::make() takes it
  std::string description;  ///< one sentence
  std::vector<OptionInfo> options;
  bool available = true;  ///< false: its library was absent when this program was built
  std::string needs;      ///< the library it needs; empty for none
};

/// The back ends that can be had by name: the built-in ones, and those that were added (by
/// load_plugin(), for instance). A value: there is no list of the process; who adds back ends hands
/// the registry on.
///
/// Thread-safety: const functions may be called from any thread, add() only while none is; the
/// solvers returned are immutable.
class SolverRegistry {
 public:
  /// Adds a back end under its own name(), which make() returns whenever it is asked for. Throws
  /// std::invalid_argument if the name is taken or is not 1 to 64 letters, digits and "_-.:", and
  /// for "unknown".
  void add(std::shared_ptr<const Solver> solver, std::string description);

  /// The back end of that name: "ceres"; "ipopt"; "hybrid"; "nlopt" or "nlopt:ALGORITHM";
  /// "sampling", "sampling:cem", "sampling:mppi" or "sampling:search"; one that was added. A back
  /// end whose library is absent is returned all the same: its explain_unsupported() and the kError
  /// of its solve() say what is missing.
  ///
  /// Throws std::invalid_argument, with the nearest valid name, if there is no such back end.
  std::shared_ptr<const Solver> make(std::string_view name) const;

  /// All names make() takes, in alphabetical order.
  std::vector<SolverInfo> list() const;

 private:
  struct Added {
    std::shared_ptr<const Solver> solver;
    std::string description;
  };
  std::vector<Added> added_;
};

/// SolverRegistry().make(name): a built-in back end.
std::shared_ptr<const Solver> make_solver(std::string_view name);

/// SolverRegistry().list(): the built-in back ends.
std::vector<SolverInfo> list_solvers();

}  // namespace prospect
