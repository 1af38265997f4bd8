// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/missions/bench/problem_set.h"
#include "problems/stated_programme.h"

namespace prospect {

/// A programme as a Problem, which takes finite bounds and c(x) >= 0 only:
///  * a bound that is infinite becomes 100 below or above, or 100 beyond the start if that is
///    farther;
///  * an equation h = b becomes two rows, 1e-6 - (h - b) >= 0 and 1e-6 + (h - b) >= 0, in the unit
///    of h where that is far from 1;
///  * a range becomes two rows, a row without bounds none.
/// BenchProblem::stated is the programme itself.
BenchProblem stated_problem(StatedProgramme programme);

}  // namespace prospect
