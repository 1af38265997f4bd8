// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/problem/problem.h"

namespace prospect {

/// One stage of a problem, to first order in its state s and its decision v. Sizes: s is ns = nx +
/// nu, v is nu; r rows of residuals, m of constraints.
struct Stage {
  /// Whether a knot begins here: then the input is v. Else it is that of the stage before, and what
  /// has derivatives by v is zero.
  bool decides = false;
  Eigen::MatrixXd A, B;  ///< of s_{k+1} = F_k(s_k, v_k): ns x ns, ns x nu; empty at the last node
  Eigen::VectorXd gap;  ///< F_k(s_k, v_k) - s_{k+1}: ns; 0 where the states are those of the inputs
  /// Costs that are sums of squares of what a stage has: 1/2 |residuals|^2.
  Eigen::VectorXd residuals;                     ///< r
  Eigen::MatrixXd residuals_s, residuals_v;      ///< r x ns, r x nu
  Eigen::VectorXd gradient_s, gradient_v;        ///< of all other costs: ns, nu
  Eigen::VectorXd constraints;                   ///< m; >= 0 is feasible
  Eigen::MatrixXd constraints_s, constraints_v;  ///< m x ns, m x nu
};

/// A problem as a chain of stages, for methods that use that structure: multiple shooting, Riccati
/// recursions, banded solvers.
///
///   min  sum_k 1/2 |r_k(s_k, v_k)|^2 + (costs that couple more than a stage)
///   s.t. s_{k+1} = F_k(s_k, v_k),   c_k(s_k, v_k) >= 0,   lower <= v_k <= upper
///
/// with the state s_k = (x_k, u_{k-1}), so that the change of an input is a matter of one stage, as
/// is move blocking: F_k(s, v) = (f(x, u), u), u = v where a knot begins and u_{k-1} elsewhere.
/// What depends on x_k and x_{k+1} (a mid-point between two nodes) is of stage k: x_{k+1} is put
/// there by F_k to first order, the gap included.
struct StageStructure {
  std::vector<Stage> stages;  ///< N + 1; the last has no decision and no dynamics
  double cost = 0.0;          ///< of the trajectory
  double offset = 0.0;        ///< of the residuals: see ResidualForm
  /// Costs that are in gradient_s and gradient_v alone: of no sum of squares, or with rows that
  /// couple more than a stage. Their curvature is not known here.
  std::vector<std::string> by_gradient;
};

/// Linearises at inputs z (n) and states of one's own (nx x (N+1), column 0 is x0), which need not
/// be those of the inputs. Throws std::invalid_argument for other sizes, for a problem without
/// gradients, and for a constraint with a row that couples more than a stage; std::domain_error
/// where a term is not evaluable. Passes on exceptions of terms. Allocates. Thread-safe.
StageStructure stage_structure(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& z,
                               const Eigen::Ref<const Eigen::MatrixXd>& states);
/// The same at the states that the inputs lead to.
StageStructure stage_structure(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& z);

}  // namespace prospect
