// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "solvers/registry.h"

namespace prospect {

/// Whether the back end of this name is one that was not built in.
bool is_absent(const std::string& solver, const SolverRegistry& registry);
/// The same; if so, standard error says in one line which library it needs.
bool tell_if_absent(const std::string& solver, const SolverRegistry& registry);

}  // namespace prospect
