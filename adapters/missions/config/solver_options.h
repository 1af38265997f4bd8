// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/files/strict_yaml.h"
#include "engine/problem/solver.h"

namespace prospect {

/// "", or what is wrong with these options for a back end, in its own words: it is asked to solve
/// the smallest problem with them. "" also for a back end that is not built in.
std::string solver_options_problem(const Solver& solver, const Options& options);

/// The options that a mapping holds, of the types that the back end tells (OptionInfo). Those that
/// it does not take are problems of the document.
Options read_solver_options(YamlMap map, const Solver& solver);

}  // namespace prospect
