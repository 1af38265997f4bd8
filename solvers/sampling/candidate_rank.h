// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace prospect {

/// Folds violations into the costs of a batch, so that one number ranks its candidates: that of one
/// with violated constraints lies above that of all feasible ones and grows with the violation;
/// without any feasible one it is the violation. Infinite for rejected candidates, whose violation
/// is.
void fold_violations(const Eigen::ArrayXd& violation, double tolerance, Eigen::ArrayXd& cost);

}  // namespace prospect
