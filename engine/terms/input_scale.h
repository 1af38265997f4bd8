// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "models/motion_model.h"

namespace prospect {

/// Diagonal of R in |u|^2_R = sum_j R_j u_j^2: R_j = 1 / (largest admissible |u_j|)^2, so that an
/// input at its bound counts 1 whatever its unit. R_j = 1 where a bound is infinite or the input is
/// fixed at zero. Our choice; the formulation asks for normalised inputs.
Eigen::VectorXd input_scale(const InputLimits& limits);

}  // namespace prospect
