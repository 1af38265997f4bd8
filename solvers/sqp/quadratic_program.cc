// SPDX-License-Identifier: Apache-2.0
#include "solvers/sqp/quadratic_program.h"

#include <Eigen/Cholesky>
#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <limits>

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A constraint is violated beyond this, relative to the size of its normal times that of x, or
// to 1.
constexpr double kViolated = 1e-12;

// A normal is taken for dependent on those of the active set if less than this share of it is
// left.
constexpr double kDependent = 1e-11;

}  // namespace

void QuadraticProgram::resize(Eigen::Index n, Eigen::Index m) {
  if (x_.size() == n && multipliers_.size() == m) return;
  x_.resize(n);
  multipliers_.resize(m);
  lower_multipliers_.resize(n);
  upper_multipliers_.resize(n);
  L_.resize(n, n);
  J_.resize(n, n);
  R_.resize(n, n);
  d_.resize(n);
  z_.resize(n);
  r_.resize(n);
  norms_.resize(m);
  row_values_.resize(m);
  u_.resize(n);
  const auto constraints = static_cast<std::size_t>(m + 2 * n);
  active_.clear();
  active_.reserve(static_cast<std::size_t>(n) + 1);
  last_active_.reserve(static_cast<std::size_t>(n) + 1);
  is_active_.assign(constraints, 0);
}

void QuadraticProgram::add() {
  const auto q = static_cast<Eigen::Index>(active_.size());
  const Eigen::Index n = x_.size();
  // Rotations of the free columns of J that leave one entry of d.
  for (Eigen::Index i = n - 1; i > q; --i) {
    if (d_[i] == 0.0) continue;
    Eigen::JacobiRotation<double> rotation;
    double length = 0.0;
    rotation.makeGivens(d_[i - 1], d_[i], &length);
    d_[i - 1] = length;
    d_[i] = 0.0;
    J_.applyOnTheRight(i - 1, i, rotation);
  }
  R_.col(q).head(q + 1) = d_.head(q + 1);
}

void QuadraticProgram::drop(Eigen::Index position) {
  const auto q = static_cast<Eigen::Index>(active_.size());
  is_active_[static_cast<std::size_t>(active_[static_cast<std::size_t>(position)])] = 0;
  active_.erase(active_.begin() + position);
  for (Eigen::Index j = position; j + 1 < q; ++j) {
    u_[j] = u_[j + 1];
    R_.col(j).head(j + 2) = R_.col(j + 1).head(j + 2);
  }
  // R is upper Hessenberg from there on.
  for (Eigen::Index j = position; j + 1 < q; ++j) {
    Eigen::JacobiRotation<double> rotation;
    double length = 0.0;
    rotation.makeGivens(R_(j, j), R_(j + 1, j), &length);
    R_(j, j) = length;
    R_(j + 1, j) = 0.0;
    if (j + 2 < q) {
      R_.block(0, j + 1, R_.rows(), q - 2 - j).applyOnTheLeft(j, j + 1, rotation.adjoint());
    }
    J_.applyOnTheRight(j, j + 1, rotation);
  }
}

QuadraticProgram::Status QuadraticProgram::solve(const Eigen::Ref<const Eigen::MatrixXd>& G,
                                                 const Eigen::Ref<const Eigen::VectorXd>& g,
                                                 const Eigen::Ref<const Eigen::MatrixXd>& A,
                                                 const Eigen::Ref<const Eigen::VectorXd>& b,
                                                 const Eigen::Ref<const Eigen::VectorXd>& lower,
                                                 const Eigen::Ref<const Eigen::VectorXd>& upper) {
  const Eigen::Index n = g.size(), m = b.size();
  resize(n, m);
  last_active_ = active_;
  active_.clear();
  std::fill(is_active_.begin(), is_active_.end(), char{0});
  steps_ = 0;

  L_ = G.triangularView<Eigen::Lower>();
  if (!L_.allFinite() || !g.allFinite()) return Status::kNotConvex;
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(L_);
  if (cholesky.info() != Eigen::Success) return Status::kNotConvex;
  J_.setIdentity();
  L_.triangularView<Eigen::Lower>().transpose().solveInPlace(J_);
  d_.noalias() = -(J_.transpose() * g);
  x_.noalias() = J_ * d_;
  for (Eigen::Index r = 0; r < m; ++r) norms_[r] = A.row(r).norm();

  const auto limit = 20 * (n + m) + 100;
  for (;;) {
    // The most violated constraint, by distance; of those that were active, if there is one.
    row_values_.noalias() = A * x_;
    row_values_ += b;
    Eigen::Index worst = -1;
    double violation = 0.0;
    const double size = 1.0 + x_.lpNorm<Eigen::Infinity>();
    const auto value = [&](Eigen::Index c) {
      if (c < m) return row_values_[c];
      return c < m + n ? x_[c - m] - lower[c - m] : upper[c - m - n] - x_[c - m - n];
    };
    const auto consider = [&](Eigen::Index c) {
      if (is_active_[static_cast<std::size_t>(c)]) return;
      double distance = value(c);
      if (c < m) {
        if (norms_[c] == 0.0) {
          // No x changes it.
          if (distance < -kViolated * size)
            distance = -kInfinity;
          else
            return;
        } else {
          distance /= norms_[c];
        }
      }
      if (distance < violation - kViolated * size) {
        violation = distance;
        worst = c;
      }
    };
    for (const int c : last_active_) consider(c);
    if (worst < 0) {
      for (Eigen::Index c = 0; c < m + 2 * n; ++c) consider(c);
    }
    if (worst < 0) break;
    if (violation == -kInfinity) return Status::kInfeasible;

    double multiplier = 0.0;
    for (;;) {
      if (++steps_ > limit) return Status::kStalled;
      const auto q = static_cast<Eigen::Index>(active_.size());
      if (worst < m) {
        d_.noalias() = J_.transpose() * A.row(worst).transpose();
      } else if (worst < m + n) {
        d_ = J_.row(worst - m).transpose();
      } else {
        d_ = -J_.row(worst - m - n).transpose();
      }
      z_.noalias() = J_.rightCols(n - q) * d_.tail(n - q);
      r_.head(q) = d_.head(q);
      R_.topLeftCorner(q, q).triangularView<Eigen::Upper>().solveInPlace(r_.head(q));
      // How far until a multiplier of the active set becomes zero.
      double dual = kInfinity;
      Eigen::Index blocking = -1;
      for (Eigen::Index j = 0; j < q; ++j) {
        if (r_[j] > 0.0 && u_[j] / r_[j] < dual) {
          dual = u_[j] / r_[j];
          blocking = j;
        }
      }
      // How far until the constraint holds.
      const double slope = d_.tail(n - q).squaredNorm();
      const bool dependent = q == n || slope <= kDependent * kDependent * d_.squaredNorm();
      const double primal = dependent ? kInfinity : -value(worst) / slope;
      const double step = std::min(dual, primal);
      if (step == kInfinity) return Status::kInfeasible;
      u_.head(q) -= step * r_.head(q);
      multiplier += step;
      if (!dependent) {
        x_ += step * z_;
        if (worst < m) row_values_[worst] = A.row(worst).dot(x_) + b[worst];
      }
      if (step == primal) {
        add();
        u_[q] = multiplier;
        active_.push_back(static_cast<int>(worst));
        is_active_[static_cast<std::size_t>(worst)] = 1;
        break;
      }
      u_[blocking] = 0.0;
      drop(blocking);
    }
  }

  tell_multipliers();
  return x_.allFinite() ? Status::kSolved : Status::kStalled;
}

void QuadraticProgram::tell_multipliers() {
  const Eigen::Index n = x_.size(), m = multipliers_.size();
  multipliers_.setZero();
  lower_multipliers_.setZero();
  upper_multipliers_.setZero();
  for (std::size_t j = 0; j < active_.size(); ++j) {
    const Eigen::Index c = active_[j];
    const double u = std::max(0.0, u_[static_cast<Eigen::Index>(j)]);
    if (c < m) {
      multipliers_[c] = u;
    } else if (c < m + n) {
      lower_multipliers_[c - m] = u;
    } else {
      upper_multipliers_[c - m - n] = u;
    }
  }
}

}  // namespace prospect
