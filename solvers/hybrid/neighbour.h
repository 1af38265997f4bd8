// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// Knot inputs near z: another manoeuvre over a part of the horizon. The inputs of the knots
/// s..s + l - 1 are replaced by a constant, the others are those of z (n),
///   l = 1 + floor(t_0 M),   s = floor(t_1 (M - l + 1)),
///   input j = spread_value(lower_j, upper_j, t_(2 + j)),
///   t_d = frac(1/2 + i phi^-(d + 1)),   phi^(D + 1) = phi + 1,   D = 2 + nu,
/// so that i = 1, 2, ... are all lengths, places and constants alike.
///
/// Keeps the bounds where z does; rate limits are up to the caller. Deterministic.
/// Source: Roberts (2018), generalised golden ratio; the stretch is our choice.
Eigen::VectorXd neighbour(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& z,
                          int i);

}  // namespace prospect
