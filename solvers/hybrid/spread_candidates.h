// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// Knot inputs that spread over what a robot can do. The first is the one nearest to zero: standing
/// still where the bounds allow. The others are constant over each of `segments` stretches of the
/// horizon (as equal as M knots allow, at most M),
///   value_ji = spread_value(lower_j, upper_j, t_ji),
///   t_ji = frac(1/2 + i phi^-(d + 1)),   d = segment nu + j,   phi^(D+1) = phi + 1,  D = segments
///   nu,
/// so that the values of all stretches together fill their box evenly, bounds included.
///
/// Returns n x count. The points keep the bounds; rate limits are up to the caller. Deterministic.
/// Source: Roberts (2018), generalised golden ratio; the stretching is our choice.
Eigen::MatrixXd spread_candidates(const Problem& problem, int count, int segments);

}  // namespace prospect
