// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solvers/evaluator.h"

/// What a local method does at its end, when its last point x is not the incumbent.
namespace prospect {

/// Moves from the feasible incumbent towards the infeasible point x as far as the segment stays
/// feasible (bisection): the solution of a method that approaches the feasible set from outside is
/// not thrown away for a far worse feasible point. Nothing to do, and nothing done, otherwise.
void approach_from_incumbent(Evaluator& evaluator, const Eigen::VectorXd& x);

/// Whether the incumbent is feasible and its cost at most that of x, within ten times the
/// tolerance: what the method has shown of x, its test of optimality, then holds for the incumbent.
bool incumbent_is_as_good(Evaluator& evaluator, const Eigen::VectorXd& x);

}  // namespace prospect
