// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace prospect {

/// Steps a_d = phi^-(d+1) of the additive recurrence frac(1/2 + i a_d), i = 1, 2, ..., whose points
/// fill the unit box of `dimensions` evenly; phi^(dimensions + 1) = phi + 1.
/// Source: Roberts (2018), generalised golden ratio.
Eigen::VectorXd additive_recurrence_steps(int dimensions);

}  // namespace prospect
