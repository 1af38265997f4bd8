#pragma once

#include <string>

#include "solvers/registry.h"

namespace prospect {

/// Opens the shared library `path` (a path, not a name to search for; its symbols stay its own) and
/// adds the back ends it offers to `registry`. See solvers/plugin.h for what the library must
/// offer.
///
/// The solvers added keep the contract of engine/problem/solver.h even where the plug-in does not:
/// an exception of its solve() becomes kError, one of its explain_unsupported() a reason why not,
/// and a result with an x of the wrong size or with a number that is not finite becomes kError.
///
/// Throws std::invalid_argument, one line `plug-in 'path': what; expected what`, and leaves the
/// registry as it was, if there is no such file, if it is no whole shared library or cannot be
/// linked, if it has no entry point, another interface version or another PluginAbi, if a name is
/// taken or not well-formed, or if the entry point or a factory throws or returns nothing.
///
/// A library that was opened stays open until the program ends: solvers, results and exceptions of
/// it may live anywhere. Loading runs the code of the library: load only what you trust.
/// Thread-safety: as for any change of `registry`; nothing else is shared.
void load_plugin(const std::string& path, SolverRegistry& registry);

}  // namespace prospect
