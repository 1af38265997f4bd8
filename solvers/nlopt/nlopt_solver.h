// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "engine/problem/solver.h"
#include "solvers/nlopt_algorithms.h"

namespace prospect {

/// `name`: as the registry calls it. Thread-safety: as Solver; NLopt's random numbers belong to the
/// thread and are seeded by every solve().
std::shared_ptr<const Solver> make_nlopt_solver(std::string name, const NloptAlgorithm& algorithm);

}  // namespace prospect
