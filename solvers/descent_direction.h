// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace prospect {

/// Direction of steepest descent that bounds and constraints leave, to first order:
///   d = argmin |d + g|   s.t.  A_r . d >= 0 for the active rows r,
///                              d_i >= 0 where x_i = lower_i,  d_i <= 0 where x_i = upper_i,
/// the projection of -g on that cone. It is zero exactly where multipliers >= 0 satisfy the
/// conditions of Karush, Kuhn and Tucker.
///
/// All in variables scaled by the widths of their bounds, which are 1 wide then: g (n) the gradient
/// of the cost, A (m x n) the gradients of the active constraints c >= 0, x within [0, 1].
///
/// The projection onto the polar cone, a least-squares problem with multipliers >= 0, is solved by
/// active sets (Lawson and Hanson 1974, chapter 23). Errors are of rounding; g, A and x finite.
/// Stateless.
///
/// `multipliers`, if not null: those of the projection, >= 0, of the m rows of A and then of the
/// bounds at which the n variables are (0 elsewhere).
Eigen::VectorXd descent_direction(const Eigen::VectorXd& g, const Eigen::MatrixXd& A,
                                  const Eigen::VectorXd& x, Eigen::VectorXd* multipliers = nullptr);

}  // namespace prospect
