// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// Constraints c(x) >= 0 folded into the cost so that they are felt before they are violated:
///
///   mu sum_i beta(c_i - margin),    beta(c) = -log c                                   for c >
///   delta
///                                           = ((c - 2 delta)^2 / delta^2 - 1) / 2 - log delta
///                                           below
///
/// twice continuously differentiable, convex and finite everywhere. Where it is least, -mu beta'
/// are estimates of the multipliers.
///
/// For methods on sums of squares, as rows r with
///   J^T r = its gradient,   J^T J = sum_i mu beta'' grad c_i grad c_i^T,   1/2 |r|^2 = its value +
///   a constant:
/// for each constraint sqrt(mu) beta' / sqrt(beta'') and sqrt(mu beta'') grad c_i, and a last one
/// without derivative for the rest of the value. They are not the residuals of a function, but
/// Levenberg and Marquardt's method looks at no more than value, gradient and J^T J, and it has the
/// barrier's own second derivative this way.
///
/// Source: Hauser, Saccon (2006); Feller, Ebenbauer (2017). The rows are our choice.
class RelaxedBarrier {
 public:
  /// mu > 0; delta > 0 [unit of constraint]; margin as in AugmentedLagrangian.
  RelaxedBarrier(double mu, double delta, double margin)
      : mu_(mu), delta_(delta), margin_(margin) {}

  double value(const Eigen::Ref<const Eigen::VectorXd>& constraints) const;
  /// r (m + 1). The constant is 100 mu m, enough for all constraint values below e^99.
  void residuals(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                 Eigen::Ref<Eigen::VectorXd> r) const;
  /// J (m + 1 x n), from jacobian (m x n).
  void residual_jacobian(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                         const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                         Eigen::Ref<ResidualJacobian> J) const;
  /// -mu beta' (m), > 0.
  Eigen::VectorXd multipliers(const Eigen::Ref<const Eigen::VectorXd>& constraints) const;

 private:
  struct Beta {
    double value, slope, curvature;
  };
  Beta beta(double constraint) const;

  double mu_, delta_, margin_;
};

}  // namespace prospect
