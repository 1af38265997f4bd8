// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// The constraints c(x) >= 0 folded into the cost, for methods that take bounds only:
///
///   L(x; lambda, rho) = f(x) + 1/(2 rho) sum_i [ max(0, lambda_i - rho (c_i - margin))^2
///                                                - lambda_i^2 ]
///   grad L            = grad f - sum_i max(0, lambda_i - rho (c_i - margin)) grad c_i
///
/// once continuously differentiable. As a sum of squares, for methods that minimise those,
///   L = f + 1/2 |r|^2 - 1/(2 rho) |lambda|^2,   r_i = max(0, lambda_i - rho (c_i - margin)) /
///   sqrt(rho).
/// Between inner minimisations
///   lambda_i <- max(0, lambda_i - rho (c_i - margin)),
/// and rho grows tenfold when  sigma = max_i |min(c_i - margin, lambda_i / rho)|  (infeasibility
/// and lack of complementarity in one, in the unit of c) fell by less than half.
///
/// The margin makes a solution feasible that is right to less than it; in the end it is half the
/// feasibility tolerance. It falls to that with sigma, margin <- max(final, min(margin / 2,
/// sigma)), so that points on the way become feasible long before the multipliers have settled: a
/// solve that is stopped early has an incumbent that is near, not one from before it began.
///
/// Source: Powell (1969), Hestenes (1969), Rockafellar (1973); the safeguards follow Andreani,
/// Birgin, Martinez, Schuverdt (2007). That it is used here, and the falling margin, are our
/// choice, measured (docs/decisions/augmented_lagrangian_margin.md).
class AugmentedLagrangian {
 public:
  struct Margin {
    double initial, final;  ///< [unit of c]; 0 <= final; an initial one below it has no effect
  };
  /// lambda: m multipliers to start from (>= 0), or empty for zeros. rho > 0.
  AugmentedLagrangian(int m, const Eigen::VectorXd& lambda, double rho, Margin margin);

  double value(double cost, const Eigen::Ref<const Eigen::VectorXd>& constraints) const;
  /// gradient: in: grad f (n), out: grad L. jacobian: m x n.
  void add_gradient(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                    const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                    Eigen::Ref<Eigen::VectorXd> gradient) const;
  /// r (m).
  void residuals(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                 Eigen::Ref<Eigen::VectorXd> r) const;
  /// Its derivative (m x n), -sqrt(rho) grad c_i where r_i > 0, from jacobian (m x n).
  void residual_jacobian(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                         const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                         Eigen::Ref<ResidualJacobian> J) const;
  /// After an inner minimisation that ended with these constraint values. Returns how far from
  /// settled they are [unit of c]: sigma, or what the margin was above the final one, if more.
  double update(const Eigen::Ref<const Eigen::VectorXd>& constraints);

  const Eigen::VectorXd& lambda() const { return lambda_; }
  double rho() const { return rho_; }

 private:
  /// lambda_i - rho (c_i - margin).
  double shifted(Eigen::Index i, double c) const { return lambda_[i] - rho_ * (c - margin_); }

  Eigen::VectorXd lambda_;
  double rho_;
  double margin_, final_margin_;
  double last_sigma_;
};

}  // namespace prospect
