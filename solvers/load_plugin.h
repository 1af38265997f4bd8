// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "engine/problem/problem_registry.h"
#include "engine/problem/term_registry.h"
#include "solvers/registry.h"

namespace prospect {

struct PluginRobot;

/// What a plug-in adds to.
struct PluginTargets {
  SolverRegistry& solvers;
  TermRegistry& terms;
  ProblemRegistry& problems;
  /// Is set to the plug-in's robot, null for none, unread (adapters/robots/user/load_robot.h).
  const PluginRobot** robot = nullptr;
};

/// Opens the shared library `path` (a path, not a name to search for; its symbols stay its own) and
/// adds the back ends, terms and problems it offers to the registries. See solvers/plugin.h for
/// what the library must offer.
///
/// The solvers added keep the contract of engine/problem/solver.h even where the plug-in does not:
/// an exception of its solve() becomes kError, one of its explain_unsupported() a reason why not,
/// and a result with an x of the wrong size or with a number that is not finite becomes kError.
///
/// Returns "" or a warning in one line: the plug-in was compiled without optimisation, so that what
/// is measured with it says little.
///
/// Throws std::invalid_argument, one line `plug-in 'path': what; expected what`, and leaves the
/// registries as they were, if there is no such file, if it is no whole shared library or cannot be
/// linked, if it has no entry point, another interface version or another PluginAbi, if a name is
/// taken or not well-formed, if an option of a term or a problem is no sound one, or if the entry
/// point or a factory of a solver throws or returns nothing.
///
/// A library that was opened stays open until the program ends: solvers, terms, results and
/// exceptions of it may live anywhere. Loading runs the code of the library: load only what you
/// trust. Thread-safety: as for any change of the registries; nothing else is shared.
std::string load_plugin(const std::string& path, const PluginTargets& targets);

/// The same for a program that wants its back ends only: terms and problems are checked, not kept.
std::string load_plugin(const std::string& path, SolverRegistry& registry);

}  // namespace prospect
