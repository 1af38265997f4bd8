#include "perception/odometry/pose_drift.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "perception/odometry/se3.h"

namespace prospect {

PoseDrift::PoseDrift(double offset_variance)
    : P_(Eigen::MatrixXd::Constant(1, 1, offset_variance)), last_(Eigen::MatrixXd::Zero(6, 1)) {}

void PoseDrift::begin(std::uint64_t anchor, const Matrix6d& covariance) {
  const double offset_variance = P_(0, 0);
  anchors_ = {anchor};
  P_ = Eigen::MatrixXd::Zero(7, 7);
  P_(0, 0) = offset_variance;
  P_.bottomRightCorner<6, 6>() = covariance;
  last_ = P_.bottomRows<6>();
  last_covariance_ = covariance;
}

PoseDrift::Matrix6d PoseDrift::measure(const std::vector<Reference>& references, const Vector6d& b,
                                       const Matrix6d& noise) {
  Matrix6d H = Matrix6d::Zero();
  for (const Reference& r : references) H += r.information;
  const Eigen::LDLT<Matrix6d> solver(H);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(6, P_.cols());
  G.col(0) = -solver.solve(b);
  for (const Reference& r : references) {
    const auto at = std::find(anchors_.begin(), anchors_.end(), r.anchor);
    if (at == anchors_.end()) continue;
    G.middleCols<6>(1 + 6 * (at - anchors_.begin())) +=
        solver.solve(r.information * adjoint(r.T_CA));
  }
  last_ = G * P_;
  const Matrix6d inherited = last_ * G.transpose();
  last_covariance_ = 0.5 * (inherited + inherited.transpose()) + noise;
  return last_covariance_;
}

PoseDrift::Matrix6d PoseDrift::since(std::uint64_t anchor, const Eigen::Isometry3d& T_CA) const {
  const auto at = std::find(anchors_.begin(), anchors_.end(), anchor);
  if (at == anchors_.end()) return last_covariance_;
  const Eigen::Index i = 1 + 6 * (at - anchors_.begin());
  const Matrix6d Ad = adjoint(T_CA);
  const Matrix6d cross = last_.middleCols<6>(i) * Ad.transpose();
  const Matrix6d C =
      last_covariance_ - cross - cross.transpose() + Ad * P_.block<6, 6>(i, i) * Ad.transpose();
  return 0.5 * (C + C.transpose());
}

void PoseDrift::add(std::uint64_t anchor) {
  const Eigen::Index n = P_.rows();
  P_.conservativeResize(n + 6, n + 6);
  P_.bottomLeftCorner(6, n) = last_;
  P_.topRightCorner(n, 6) = last_.transpose();
  P_.bottomRightCorner<6, 6>() = last_covariance_;
  anchors_.push_back(anchor);
  // Measured from: this pose, once more.
  last_ = P_.bottomRows<6>();
}

void PoseDrift::keep(const std::set<std::uint64_t>& anchors) {
  std::vector<Eigen::Index> rows = {0};
  std::vector<std::uint64_t> kept;
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    if (!anchors.contains(anchors_[i])) continue;
    kept.push_back(anchors_[i]);
    for (Eigen::Index k = 0; k < 6; ++k) rows.push_back(1 + 6 * static_cast<Eigen::Index>(i) + k);
  }
  P_ = P_(rows, rows).eval();
  last_ = last_(Eigen::all, rows).eval();
  anchors_ = kept;
}

void PoseDrift::update_offset(double predicted_variance, double variance) {
  const double share = predicted_variance > 0.0 ? variance / predicted_variance : 0.0;
  P_.row(0) *= share;
  P_.col(0) *= share;
  last_.col(0) *= share;
  P_(0, 0) = variance;
}

}  // namespace prospect
