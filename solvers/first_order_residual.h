// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// How far a point is from the conditions of Karush, Kuhn and Tucker, whatever back end found it:
///
///   |d|_inf / max(1, |cost|),   d = descent_direction(g, A, s)
///
/// in variables that are shares of typical_change(): g the gradient of the cost, A that of the
/// active constraints. So it is the relative change of the cost, to first order, over such a change
/// of one variable, along the steepest way down that bounds and active constraints leave. 0:
/// multipliers >= 0 fulfil the conditions. It says nothing of saddles: see judge.h. [-]
///
/// Active is a constraint of at most 10 `feasibility_tolerance`, and a bound that is within 1e-6 of
/// its width. Variables of equal bounds are left out. Infinite at a point that violates a
/// constraint by more than `feasibility_tolerance`; NaN where the problem has no gradient, is not
/// evaluable, or x has not its size. Passes on exceptions of terms. Thread-safe; one evaluation
/// with gradient.
double first_order_residual(const Problem& problem, const Eigen::VectorXd& x,
                            double feasibility_tolerance);

}  // namespace prospect
