// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "engine/problem/solver.h"

namespace prospect {

/// Ceres: Levenberg-Marquardt on the sum of squares that the cost is,
///   J(z) = offset + 1/2 |r(z)|^2    (ResidualForm),   lower <= z <= upper.
/// Takes problems whose costs all have a residual form for the sign of their weight, and names
/// those that have none. The Hessian is that of Gauss and Newton: no second derivatives, yet
/// curvature from the first evaluation on.
///
/// Constraints c(z) >= 0 are a relaxed barrier at first (relaxed_barrier.h), which a step feels
/// before it violates them, then the residuals of an augmented Lagrangian (augmented_lagrangian.h)
/// with an outer loop.
///
/// Ceres projects its steps onto the bounds but computes them without; so that a
/// variable on its bound which the gradient pushes outwards does not bend the step of the others,
/// its column of the Jacobian is zero while that is so (the projected gradient does not change).
///
/// One evaluation of the problem gives cost, residuals and Jacobian at a trial point, whether the
/// step is then taken or not: most are.
///
/// Warm start: x, and the multipliers lambda of the constraints, with which there is no barrier.
///
/// Thread-safety: as Solver. One thread a solve.
/// Written for Ceres 2.1.
std::shared_ptr<const Solver> make_ceres_solver();

}  // namespace prospect
