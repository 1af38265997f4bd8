// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "solvers/registry.h"

namespace prospect {

/// A back end with the options it is run with.
struct SolverChoice {
  std::string label;  ///< "hybrid,candidates=200", as it was asked for
  std::shared_ptr<const Solver> solver;
  Options options;
};

/// A list as the command line splits it at commas: names of back ends, each followed by options of
/// its own, NAME=VALUE ({"hybrid", "candidates=200", "nlopt"}). Throws InputError in one line for
/// an unknown back end (with the nearest name), one that is named twice alike, an option it does
/// not have, or a value that it does not take: it is asked to solve a small problem with it.
std::vector<SolverChoice> choose_solvers(const std::vector<std::string>& words,
                                         const SolverRegistry& registry);

}  // namespace prospect
