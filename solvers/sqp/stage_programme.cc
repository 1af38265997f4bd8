// SPDX-License-Identifier: Apache-2.0
#include "solvers/sqp/stage_programme.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace prospect {
namespace {

// A variable is out of its bounds beyond this, relative to the largest of all, or to 1; a
// multiplier of the wrong sign counts beyond this, relative to the largest entry of the gradient.
constexpr double kWrong = 1e-12;

// Rounds in which all that are wrong are exchanged, though there are no fewer of them.
constexpr int kBlockTries = 3;

/// Columns of a matrix by stage or knot, of a size that may be known to the compiler.
template <int Rows, int Columns>
auto block(Eigen::MatrixXd& all, Eigen::Index i, Eigen::Index columns) {
  return Eigen::Map<Eigen::Matrix<double, Rows, Columns>>(all.data() + i * columns * all.rows(),
                                                          all.rows(), columns);
}

}  // namespace

StageProgramme::StageProgramme(const Problem& problem)
    : problem_(problem),
      nx_(problem.horizon().nx()),
      nu_(problem.horizon().nu()),
      n_(problem.num_variables()) {
  const Eigen::Index N = problem.horizon().N, M = problem.definition().M;
  A_.setZero(nx_, N * nx_);
  B_.setZero(nx_, N * nu_);
  gap_.setZero(nx_, N);
  Kx_.setZero(nu_, M * nx_);
  Qx_ = Kx_;
  Kv_.setZero(nu_, M * nu_);
  C_ = R_ = Kv_;
  k_.setZero(nu_, M);
  r_ = k_;
  x_.setZero(n_);
  multipliers_ = bound_ = x_;
  side_.assign(static_cast<std::size_t>(n_), 0);
  wrong_.reserve(static_cast<std::size_t>(n_));
}

void StageProgramme::linearise(const Eigen::Ref<const Eigen::MatrixXd>& X,
                               const Eigen::Ref<const Eigen::VectorXd>& z) {
  const ProblemDefinition& d = problem_.definition();
  for (int k = 0; k < d.N; ++k) {
    d.model->jacobians(X.col(k), z.segment(problem_.knot(k) * nu_, nu_), d.dt,
                       A_.middleCols(k * nx_, nx_), B_.middleCols(k * nu_, nu_));
  }
}

template <int NX, int NU>
bool StageProgramme::recur(const Eigen::Ref<const Eigen::MatrixXd>& P,
                           const Eigen::Ref<const Eigen::MatrixXd>& H,
                           const Eigen::Ref<const Eigen::VectorXd>& h,
                           const Eigen::Ref<const Eigen::VectorXd>& g) {
  using Mxx = Eigen::Matrix<double, NX, NX>;
  using Mux = Eigen::Matrix<double, NU, NX>;
  using Muu = Eigen::Matrix<double, NU, NU>;
  using Vx = Eigen::Matrix<double, NX, 1>;
  using Vu = Eigen::Matrix<double, NU, 1>;
  const Eigen::Index N = gap_.cols();
  // The cost to go, 1/2 x^T Wxx x + u^T Wux x + 1/2 u^T Wuu u + wx^T x + wu^T u, with the input u
  // that is in force before it.
  Mxx Wxx = P.middleCols(N * nx_, nx_);
  Mux Wux = Mux::Zero(nu_, nx_);
  Muu Wuu = Muu::Zero(nu_, nu_), L(nu_, nu_);
  Vx wx = Vx::Zero(nx_), t(nx_);
  Vu wu = Vu::Zero(nu_), fixed(nu_);
  Mxx WA(nx_, nx_);
  Eigen::Matrix<double, NX, NU> WB(nx_, nu_);
  Muu UB(nu_, nu_);
  Eigen::LLT<Muu> cholesky(nu_);
  for (Eigen::Index k = N - 1; k >= 0; --k) {
    const auto A = block<NX, NX>(A_, k, nx_);
    const auto B = block<NX, NU>(B_, k, nu_);
    const auto gap = block<NX, 1>(gap_, k, 1);
    t = wx;
    t.noalias() += Wxx * gap;
    wu.noalias() += Wux * gap;
    wu.noalias() += B.transpose() * t;
    wx.noalias() = A.transpose() * t;
    WA.noalias() = Wxx * A;
    WB.noalias() = Wxx * B;
    UB.noalias() = Wux * B;
    Wuu += UB + UB.transpose();
    Wuu.noalias() += B.transpose() * WB;
    const Mux UA = Wux * A;
    Wux = UA;
    Wux.noalias() += B.transpose() * WA;
    Wxx.noalias() = A.transpose() * WA;
    if (k > 0) Wxx += P.middleCols(k * nx_, nx_);
    const int m = problem_.knot(static_cast<int>(k));
    if (k > 0 && m == problem_.knot(static_cast<int>(k - 1))) continue;
    // A knot begins here: its input is chosen.
    const Eigen::Index at = m * nu_;
    auto R = block<NU, NU>(R_, m, nu_);
    auto C = block<NU, NU>(C_, m, nu_);
    auto Qx = block<NU, NX>(Qx_, m, nx_);
    auto r = block<NU, 1>(r_, m, 1);
    auto Kx = block<NU, NX>(Kx_, m, nx_);
    auto Kv = block<NU, NU>(Kv_, m, nu_);
    auto offset = block<NU, 1>(k_, m, 1);
    R = Wuu + H.block(at, at, nu_, nu_);
    R.diagonal() += h.segment(at, nu_);
    C.setZero();
    if (m > 0) C = H.block(at, at - nu_, nu_, nu_);
    Qx = Wux;
    r = wu + g.segment(at, nu_);
    fixed = bound_.segment(at, nu_);
    L = R;
    Kx = -Qx;
    Kv = -C;
    offset = -r;
    offset.noalias() -= R * fixed;
    for (Eigen::Index j = 0; j < nu_; ++j) {
      if (side_[static_cast<std::size_t>(at + j)] == 0) continue;
      L.row(j).setZero();
      L.col(j).setZero();
      L(j, j) = 1.0;
      Kx.row(j).setZero();
      Kv.row(j).setZero();
      offset[j] = 0.0;
    }
    cholesky.compute(L);
    if (cholesky.info() != Eigen::Success) return false;
    cholesky.solveInPlace(Kx);
    cholesky.solveInPlace(Kv);
    cholesky.solveInPlace(offset);
    offset += fixed;
    // What is free is the best for any x and v, so that its derivatives drop out.
    wx.noalias() += Qx.transpose() * offset;
    wu.noalias() = C.transpose() * offset;
    Wxx.noalias() += Qx.transpose() * Kx;
    Wux.noalias() = C.transpose() * Kx;
    Wuu.noalias() = C.transpose() * Kv;
  }
  return true;
}

template <int NX, int NU>
void StageProgramme::go_forward() {
  using Vx = Eigen::Matrix<double, NX, 1>;
  using Vu = Eigen::Matrix<double, NU, 1>;
  Vx x = Vx::Zero(nx_), next(nx_);
  Vu u = Vu::Zero(nu_), before(nu_), slope(nu_);
  for (Eigen::Index k = 0; k < gap_.cols(); ++k) {
    const int m = problem_.knot(static_cast<int>(k));
    if (k == 0 || m != problem_.knot(static_cast<int>(k - 1))) {
      before = u;
      u = block<NU, 1>(k_, m, 1);
      u.noalias() += block<NU, NX>(Kx_, m, nx_) * x;
      u.noalias() += block<NU, NU>(Kv_, m, nu_) * before;
      slope = block<NU, 1>(r_, m, 1);
      slope.noalias() += block<NU, NX>(Qx_, m, nx_) * x;
      slope.noalias() += block<NU, NU>(C_, m, nu_) * before;
      slope.noalias() += block<NU, NU>(R_, m, nu_) * u;
      x_.segment(m * nu_, nu_) = u;
      multipliers_.segment(m * nu_, nu_) = slope;
    }
    next = block<NX, 1>(gap_, k, 1);
    next.noalias() += block<NX, NX>(A_, k, nx_) * x;
    next.noalias() += block<NX, NU>(B_, k, nu_) * u;
    x = next;
  }
}

bool StageProgramme::exchange(const Eigen::Ref<const Eigen::VectorXd>& lower,
                              const Eigen::Ref<const Eigen::VectorXd>& upper, double size) {
  wrong_.clear();
  const double reach = kWrong * (1.0 + x_.lpNorm<Eigen::Infinity>());
  for (Eigen::Index j = 0; j < n_; ++j) {
    const signed char side = side_[static_cast<std::size_t>(j)];
    const bool wrong = side == 0 ? x_[j] < lower[j] - reach || x_[j] > upper[j] + reach
                                 : side * multipliers_[j] > kWrong * size && lower[j] < upper[j];
    if (wrong) wrong_.push_back(j);
  }
  if (wrong_.empty()) return false;
  if (wrong_.size() < fewest_) {
    fewest_ = wrong_.size();
    tries_ = kBlockTries;
  } else if (--tries_ < 0) {
    wrong_.erase(wrong_.begin(), wrong_.end() - 1);
  }
  for (const Eigen::Index j : wrong_) {
    signed char& side = side_[static_cast<std::size_t>(j)];
    side = static_cast<signed char>(side != 0 ? 0 : (x_[j] < lower[j] ? -1 : 1));
  }
  return true;
}

StageProgramme::Status StageProgramme::solve(const Eigen::Ref<const Eigen::MatrixXd>& P,
                                             const Eigen::Ref<const Eigen::MatrixXd>& H,
                                             const Eigen::Ref<const Eigen::VectorXd>& h,
                                             const Eigen::Ref<const Eigen::VectorXd>& g,
                                             const Eigen::Ref<const Eigen::MatrixXd>& drift,
                                             const Eigen::Ref<const Eigen::VectorXd>& lower,
                                             const Eigen::Ref<const Eigen::VectorXd>& upper) {
  rounds_ = 0;
  if (!P.allFinite() || !H.allFinite() || !g.allFinite()) return Status::kNotConvex;
  for (Eigen::Index at = 0; at + 2 * nu_ < n_; at += nu_) {
    if (!H.block(at + 2 * nu_, at, n_ - at - 2 * nu_, nu_).isZero(0.0)) return Status::kNotOfStages;
  }
  for (Eigen::Index k = 0; k < gap_.cols(); ++k) {
    gap_.col(k) = drift.col(k + 1);
    gap_.col(k).noalias() -= A_.middleCols(k * nx_, nx_) * drift.col(k);
  }
  fewest_ = static_cast<std::size_t>(n_) + 1;
  tries_ = kBlockTries;
  const double size = std::max(g.lpNorm<Eigen::Infinity>(), 1e-300);
  const Eigen::Index limit = 20 + 10 * n_;
  const bool planar = nx_ == 3 && nu_ == 2;
  for (;;) {
    if (++rounds_ > limit) return Status::kStalled;
    for (Eigen::Index j = 0; j < n_; ++j) {
      const signed char side = side_[static_cast<std::size_t>(j)];
      bound_[j] = side == 0 ? 0.0 : (side < 0 ? lower[j] : upper[j]);
    }
    if (!(planar ? recur<3, 2>(P, H, h, g) : recur<Eigen::Dynamic, Eigen::Dynamic>(P, H, h, g))) {
      return Status::kNotConvex;
    }
    planar ? go_forward<3, 2>() : go_forward<Eigen::Dynamic, Eigen::Dynamic>();
    if (!x_.allFinite()) return Status::kNotConvex;
    if (!exchange(lower, upper, size)) break;
  }
  for (Eigen::Index j = 0; j < n_; ++j) {
    if (side_[static_cast<std::size_t>(j)] == 0) multipliers_[j] = 0.0;
  }
  x_ = x_.cwiseMax(lower).cwiseMin(upper);
  return Status::kSolved;
}

}  // namespace prospect
