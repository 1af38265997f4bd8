#include "perception/odometry/pose_drift.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "engine/support/cholesky.h"
#include "perception/odometry/se3.h"

namespace prospect {
namespace {

constexpr Eigen::Index kC = kCalibrationErrors;

}  // namespace

PoseDrift::PoseDrift(const Calibration& calibration)
    : P_(calibration),
      to_landmarks_(kC, 0),
      variances_(0),
      last_(Eigen::MatrixXd::Zero(6, kC)),
      last_to_landmarks_(6, 0) {}

Eigen::Index PoseDrift::row_of(std::uint64_t anchor) const {
  const auto at = std::find(anchors_.begin(), anchors_.end(), anchor);
  return at == anchors_.end() ? -1 : kC + 6 * (at - anchors_.begin());
}

void PoseDrift::begin(std::uint64_t anchor, const Matrix6d& covariance) {
  const Calibration calibration = P_.topLeftCorner<kC, kC>();
  anchors_ = {anchor};
  landmarks_.clear();
  P_ = Eigen::MatrixXd::Zero(kC + 6, kC + 6);
  P_.topLeftCorner<kC, kC>() = calibration;
  P_.bottomRightCorner<6, 6>() = covariance;
  to_landmarks_.resize(kC + 6, 0);
  variances_.resize(0);
  last_ = P_.bottomRows<6>();
  last_to_landmarks_.resize(6, 0);
  last_covariance_ = covariance;
}

PoseDrift::Matrix6d PoseDrift::measure(const Measurement& m) {
  // Landmarks are numbered in the order in which they are made: new ones come last.
  std::vector<const Sight*> added;
  for (const Sight& s : m.sights) {
    if (!std::binary_search(landmarks_.begin(), landmarks_.end(), s.landmark)) added.push_back(&s);
  }
  if (!added.empty()) {
    std::vector<std::uint64_t> all = landmarks_;
    for (const Sight* s : added) all.push_back(s->landmark);
    std::sort(all.begin(), all.end());
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(all.size());
    Eigen::MatrixXd to_landmarks = Eigen::MatrixXd::Zero(P_.rows(), n);
    Eigen::VectorXd variances = Eigen::VectorXd::Zero(n);
    const auto place = [&](std::uint64_t id) {
      return 3 * (std::lower_bound(all.begin(), all.end(), id) - all.begin());
    };
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      const Eigen::Index from = 3 * static_cast<Eigen::Index>(i), to = place(landmarks_[i]);
      to_landmarks.middleCols<3>(to) = to_landmarks_.middleCols<3>(from);
      variances.segment<3>(to) = variances_.segment<3>(from);
    }
    for (const Sight* s : added) variances.segment<3>(place(s->landmark)) = s->variance;
    to_landmarks_.swap(to_landmarks);
    variances_.swap(variances);
    landmarks_.swap(all);
  }

  Matrix6d H = Matrix6d::Zero();
  for (const Reference& r : m.references) H += r.information;
  const Eigen::LDLT<Matrix6d> solver(H);
  Eigen::MatrixXd by_state = Eigen::MatrixXd::Zero(6, P_.cols());
  by_state.leftCols<kC>() = -solver.solve(m.by_calibration);
  for (const Reference& r : m.references) {
    const Eigen::Index row = row_of(r.anchor);
    if (row >= 0) by_state.middleCols<6>(row) += solver.solve(r.information * adjoint(r.T_CA));
  }
  Eigen::MatrixXd by_landmark = Eigen::MatrixXd::Zero(6, variances_.size());
  for (const Sight& s : m.sights) {
    const auto at = std::lower_bound(landmarks_.begin(), landmarks_.end(), s.landmark);
    by_landmark.middleCols<3>(3 * (at - landmarks_.begin())) = solver.solve(s.gain);
  }
  last_ = by_state * P_;
  last_.noalias() += by_landmark * to_landmarks_.transpose();
  last_to_landmarks_ = by_landmark * variances_.asDiagonal();
  last_to_landmarks_.noalias() += by_state * to_landmarks_;
  const Matrix6d inherited =
      last_ * by_state.transpose() + last_to_landmarks_ * by_landmark.transpose();
  last_covariance_ = 0.5 * (inherited + inherited.transpose()) + m.noise;
  return last_covariance_;
}

PoseDrift::Matrix6d PoseDrift::since(std::uint64_t anchor, const Eigen::Isometry3d& T_CA) const {
  const Eigen::Index row = row_of(anchor);
  if (row < 0) return last_covariance_;
  const Matrix6d Ad = adjoint(T_CA);
  const Matrix6d cross = last_.middleCols<6>(row) * Ad.transpose();
  const Matrix6d C =
      last_covariance_ - cross - cross.transpose() + Ad * P_.block<6, 6>(row, row) * Ad.transpose();
  return 0.5 * (C + C.transpose());
}

void PoseDrift::add(std::uint64_t anchor) {
  const Eigen::Index n = P_.rows();
  P_.conservativeResize(n + 6, n + 6);
  P_.bottomLeftCorner(6, n) = last_;
  P_.topRightCorner(n, 6) = last_.transpose();
  P_.bottomRightCorner<6, 6>() = last_covariance_;
  to_landmarks_.conservativeResize(n + 6, Eigen::NoChange);
  to_landmarks_.bottomRows<6>() = last_to_landmarks_;
  anchors_.push_back(anchor);
  // Measured from: this pose, once more.
  last_ = P_.bottomRows<6>();
}

void PoseDrift::keep(const std::set<std::uint64_t>& anchors,
                     const std::set<std::uint64_t>& landmarks) {
  std::vector<Eigen::Index> rows, columns;
  for (Eigen::Index i = 0; i < kC; ++i) rows.push_back(i);
  std::vector<std::uint64_t> kept, kept_landmarks;
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    if (!anchors.contains(anchors_[i])) continue;
    kept.push_back(anchors_[i]);
    for (Eigen::Index k = 0; k < 6; ++k) rows.push_back(kC + 6 * static_cast<Eigen::Index>(i) + k);
  }
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    if (!landmarks.contains(landmarks_[i])) continue;
    kept_landmarks.push_back(landmarks_[i]);
    for (Eigen::Index k = 0; k < 3; ++k) columns.push_back(3 * static_cast<Eigen::Index>(i) + k);
  }
  if (kept.size() == anchors_.size() && kept_landmarks.size() == landmarks_.size()) return;
  P_ = P_(rows, rows).eval();
  to_landmarks_ = to_landmarks_(rows, columns).eval();
  variances_ = variances_(columns).eval();
  last_ = last_(Eigen::all, rows).eval();
  last_to_landmarks_ = last_to_landmarks_(Eigen::all, columns).eval();
  anchors_ = kept;
  landmarks_ = kept_landmarks;
}

void PoseDrift::update_calibration(int error, double predicted_variance, double variance) {
  const double share = predicted_variance > 0.0 ? variance / predicted_variance : 0.0;
  P_.row(error) *= share;
  P_.col(error) *= share;
  to_landmarks_.row(error) *= share;
  last_.col(error) *= share;
  P_(error, error) = variance;
}

}  // namespace prospect
