// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solvers/evaluator.h"

namespace prospect {

/// Standard normal numbers, free variables x columns, drawn once from the evaluator's seed: drawing
/// them anew can cost more than evaluating what they make. Every other column is correlated over
/// the knots, eps_m = c eps_{m-1} + sqrt(1 - c^2) eta_m, c = correlation.
Eigen::MatrixXd noise_bank(const Evaluator& evaluator, int columns, double correlation);

}  // namespace prospect
