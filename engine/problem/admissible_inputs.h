// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// Knot inputs that the motors can follow, near those given: knot after knot,
///   u_m <- clamp(u_m, u_{m-1} +- rate dt), then into the bounds,       u_{-1} the input in force,
///   u_m <- b + s (u_m - b) with the largest s in [0, 1] that keeps the model's limits on speeds at
///          every stage of the knot, b the input that brakes over the knot.
/// With slow zones the limits on speeds are also those of ZoneMap::approach_speed(), at the ends
/// and in the middle of every stage, for half of the deceleration that the knots leave, so that a
/// plan is slow enough by the time it is in one.
/// A point that keeps all of this is returned unchanged. Solvers keep constraints up to a
/// tolerance, and an infeasible incumbent does not keep them at all; motors have no tolerance.
///
/// z: n, finite. If the present state itself is too fast, the result brakes.
/// Thread-safety: no state. Source: our choice.
Eigen::VectorXd admissible_inputs(const Problem& problem,
                                  const Eigen::Ref<const Eigen::VectorXd>& z);

}  // namespace prospect
