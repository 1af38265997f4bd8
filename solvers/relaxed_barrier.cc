// SPDX-License-Identifier: Apache-2.0
#include "solvers/relaxed_barrier.h"

#include <algorithm>
#include <cmath>

namespace prospect {

RelaxedBarrier::Beta RelaxedBarrier::beta(double constraint) const {
  const double c = constraint - margin_;
  if (c > delta_) return {-std::log(c), -1.0 / c, 1.0 / (c * c)};
  const double t = (c - 2.0 * delta_) / delta_;
  return {0.5 * (t * t - 1.0) - std::log(delta_), t / delta_, 1.0 / (delta_ * delta_)};
}

double RelaxedBarrier::value(const Eigen::Ref<const Eigen::VectorXd>& constraints) const {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < constraints.size(); ++i) sum += beta(constraints[i]).value;
  return mu_ * sum;
}

void RelaxedBarrier::residuals(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                               Eigen::Ref<Eigen::VectorXd> r) const {
  const Eigen::Index m = constraints.size();
  double rest = 100.0 * mu_ * static_cast<double>(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Beta b = beta(constraints[i]);
    r[i] = std::sqrt(mu_ / b.curvature) * b.slope;
    rest += mu_ * b.value - 0.5 * r[i] * r[i];
  }
  r[m] = std::sqrt(2.0 * std::max(0.0, rest));
}

void RelaxedBarrier::residual_jacobian(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                                       const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                                       Eigen::Ref<ResidualJacobian> J) const {
  const Eigen::Index m = constraints.size();
  for (Eigen::Index i = 0; i < m; ++i) {
    J.row(i) = std::sqrt(mu_ * beta(constraints[i]).curvature) * jacobian.row(i);
  }
  J.row(m).setZero();
}

Eigen::VectorXd RelaxedBarrier::multipliers(
    const Eigen::Ref<const Eigen::VectorXd>& constraints) const {
  Eigen::VectorXd lambda(constraints.size());
  for (Eigen::Index i = 0; i < lambda.size(); ++i) lambda[i] = -mu_ * beta(constraints[i]).slope;
  return lambda;
}

}  // namespace prospect
