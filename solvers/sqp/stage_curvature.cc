// SPDX-License-Identifier: Apache-2.0
#include "solvers/sqp/stage_curvature.h"

#include <cmath>
#include <cstddef>

#include "engine/support/eigenvalues.h"

namespace prospect {
namespace {

// The formula divides by residual^T s: not where that is a smaller share of both lengths.
constexpr double kLeastCosine = 0.1;
// A shorter way tells rounding. [unit of the states]
constexpr double kLeastWay = 1e-6;

}  // namespace

void StageCurvature::reset(int nx, int nodes) {
  nx_ = nx;
  H_.setZero(nx, nx * nodes);
  P_.setZero(nx, nx * nodes);
  residual_.resize(nx);
  eigen_.compute(Eigen::MatrixXd::Zero(nx, nx));
}

void StageCurvature::difference(int i, double step, const Eigen::Ref<const Eigen::MatrixXd>& here,
                                const Eigen::Ref<const Eigen::MatrixXd>& moved) {
  for (Eigen::Index k = 0; k < here.cols(); ++k) {
    H_.col(k * nx_ + i) = (moved.col(k) - here.col(k)) / step;
  }
}

void StageCurvature::symmetrise() {
  for (Eigen::Index first = 0; first < H_.cols(); first += nx_) {
    node_ = H_.middleCols(first, nx_);
    H_.middleCols(first, nx_) = 0.5 * (node_ + node_.transpose());
  }
}

void StageCurvature::update(const Eigen::Ref<const Eigen::MatrixXd>& s,
                            const Eigen::Ref<const Eigen::MatrixXd>& y) {
  for (Eigen::Index k = 1; k < s.cols(); ++k) {
    auto H = H_.middleCols(k * nx_, nx_);
    residual_ = y.col(k);
    residual_.noalias() -= H * s.col(k);
    const double way = s.col(k).norm();
    const double along = residual_.dot(s.col(k));
    if (way < kLeastWay || !(std::abs(along) > kLeastCosine * residual_.norm() * way)) continue;
    H.noalias() += residual_ * residual_.transpose() / along;
  }
}

void StageCurvature::project(double least) {
  const auto raise = [least](const auto& eigen, auto P) {
    P.noalias() = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(least).asDiagonal() *
                  eigen.eigenvectors().transpose();
  };
  for (Eigen::Index first = nx_; first < H_.cols(); first += nx_) {
    const auto H = H_.middleCols(first, nx_);
    auto P = P_.middleCols(first, nx_);
    if (H.isZero(0.0)) {
      P.setZero();
    } else if (nx_ == 3) {
      eigen3_.compute(Eigen::Matrix3d(H));
      raise(eigen3_, P.leftCols<3>().topRows<3>());
    } else {
      eigen_.compute(H);
      raise(eigen_, P);
    }
  }
}

void StageCurvature::condense(double least, const std::vector<Eigen::MatrixXd>& sensitivity,
                              const Eigen::Ref<const Eigen::MatrixXd>& drift,
                              Eigen::MatrixXd& hessian, Eigen::VectorXd& gradient) {
  project(least);
  PS_.resize(nx_, gradient.size());
  for (std::size_t k = 1; k < sensitivity.size(); ++k) {
    const auto node = static_cast<Eigen::Index>(k);
    const auto P = P_.middleCols(node * nx_, nx_);
    if (P.isZero(0.0)) continue;
    // Inputs after node k do not move it: the last columns are zero.
    const Eigen::MatrixXd& S = sensitivity[k];
    Eigen::Index columns = S.cols();
    while (columns > 0 && S.col(columns - 1).isZero(0.0)) --columns;
    PS_.leftCols(columns).noalias() = P * S.leftCols(columns);
    hessian.topLeftCorner(columns, columns).noalias() +=
        S.leftCols(columns).transpose() * PS_.leftCols(columns);
    gradient.head(columns).noalias() += PS_.leftCols(columns).transpose() * drift.col(node);
  }
}

}  // namespace prospect
