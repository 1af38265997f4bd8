// SPDX-License-Identifier: Apache-2.0
#include "solvers/augmented_lagrangian.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prospect {
namespace {

// Beyond these the inner problem is too ill-conditioned to be solved at all.
constexpr double kLargestMultiplier = 1e8;
constexpr double kLargestPenalty = 1e8;

}  // namespace

AugmentedLagrangian::AugmentedLagrangian(int m, const Eigen::VectorXd& lambda, double rho,
                                         Margin margin)
    : rho_(rho),
      margin_(std::max(margin.initial, margin.final)),
      final_margin_(margin.final),
      last_sigma_(std::numeric_limits<double>::infinity()) {
  lambda_.setZero(m);
  if (lambda.size() == m && lambda.allFinite()) {
    lambda_ = lambda.cwiseMax(0.0).cwiseMin(kLargestMultiplier);
  }
}

double AugmentedLagrangian::value(double cost,
                                  const Eigen::Ref<const Eigen::VectorXd>& constraints) const {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < constraints.size(); ++i) {
    const double pull = std::max(0.0, shifted(i, constraints[i]));
    sum += pull * pull - lambda_[i] * lambda_[i];
  }
  return cost + sum / (2.0 * rho_);
}

void AugmentedLagrangian::add_gradient(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                                       const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                                       Eigen::Ref<Eigen::VectorXd> gradient) const {
  for (Eigen::Index i = 0; i < constraints.size(); ++i) {
    const double pull = shifted(i, constraints[i]);
    if (pull > 0.0) gradient -= pull * jacobian.row(i).transpose();
  }
}

void AugmentedLagrangian::residuals(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                                    Eigen::Ref<Eigen::VectorXd> r) const {
  for (Eigen::Index i = 0; i < constraints.size(); ++i) {
    r[i] = std::max(0.0, shifted(i, constraints[i])) / std::sqrt(rho_);
  }
}

void AugmentedLagrangian::residual_jacobian(const Eigen::Ref<const Eigen::VectorXd>& constraints,
                                            const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                                            Eigen::Ref<ResidualJacobian> J) const {
  for (Eigen::Index i = 0; i < constraints.size(); ++i) {
    const bool pulls = shifted(i, constraints[i]) > 0.0;
    J.row(i) = (pulls ? -std::sqrt(rho_) : 0.0) * jacobian.row(i);
  }
}

double AugmentedLagrangian::update(const Eigen::Ref<const Eigen::VectorXd>& constraints) {
  double sigma = 0.0;
  for (Eigen::Index i = 0; i < constraints.size(); ++i) {
    sigma = std::max(sigma, std::abs(std::min(constraints[i] - margin_, lambda_[i] / rho_)));
    lambda_[i] = std::clamp(shifted(i, constraints[i]), 0.0, kLargestMultiplier);
  }
  if (sigma > 0.5 * last_sigma_) rho_ = std::min(10.0 * rho_, kLargestPenalty);
  last_sigma_ = sigma;
  const double above = margin_ - final_margin_;
  // Halved at least: a feasible set that is thinner than the margin would keep sigma as it is.
  margin_ = std::max(final_margin_, std::min(0.5 * margin_, sigma));
  return std::max(sigma, above);
}

}  // namespace prospect
