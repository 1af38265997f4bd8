// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solvers/evaluator.h"
#include "solvers/sampling/rate_projection.h"

namespace prospect {

/// Local refinement without derivatives, in batches: polls x ± step along every free variable and,
/// if there are several knots, along "this input from this knot on"; to the polls comes the point
/// where the parabolas through the three values along each direction of the first kind have their
/// minima, and the extrapolation of the last success. The best candidate is taken if better than x
/// (feasible first, then cheaper, see Evaluator); else the step is halved.
///
/// Starts at the incumbent with `step`, ends below `convergence` (both fractions of the ranges) or
/// when the evaluator stops. Returns whether it converged.
///
/// Source: pattern search, Hooke and Jeeves (1961), Torczon (1997); random directions: Audet and
/// Dennis (2006); parabola step: our choice.
bool pattern_search(Evaluator& evaluator, const RateProjection& rate, bool rate_feasible,
                    double step, double convergence);

}  // namespace prospect
