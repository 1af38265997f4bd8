#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"
#include "engine/problem/solver.h"

namespace prospect {

/// Largest first_order_residual() of what may be called an optimum. [-]
inline constexpr double kOptimalityTolerance = 1e-2;

/// How far a point is from the conditions of Karush, Kuhn and Tucker, whatever back end found it:
///
///   |d|_inf / max(1, |cost|),   d = descent_direction(g, A, s)
///
/// in variables s = (x - lower) / (upper - lower), the shares of the widths of their bounds: g the
/// gradient of the cost by s, A that of the active constraints. So it is the relative change of the
/// cost, to first order, over the whole width of the bounds of one variable, along the steepest way
/// down that bounds and active constraints leave. 0: multipliers >= 0 fulfil the conditions. [-]
///
/// Active is a constraint of at most 10 `feasibility_tolerance`, and a bound that is within 1e-6 of
/// its width. Variables of equal bounds are left out. Infinite at a point that violates a
/// constraint by more than `feasibility_tolerance`; NaN where the problem has no gradient, is not
/// evaluable, or x has not its size. Passes on exceptions of terms. Thread-safe; one evaluation
/// with gradient.
double first_order_residual(const Problem& problem, const Eigen::VectorXd& x,
                            double feasibility_tolerance);

/// What a claim of a back end is worth: kFeasibleOptimum stands where the residual is at most
/// kOptimalityTolerance, and is kFeasible where it is more or not known. Other claims stand.
Quality verified_quality(Quality claimed, double first_order_residual);

}  // namespace prospect
