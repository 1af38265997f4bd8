// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/pose_drift.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "engine/support/cholesky.h"
#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index kC = kCalibrationErrors;
/// Of a place that is free.
constexpr std::uint64_t kNone = ~std::uint64_t{0};
/// Places grow by so many at a time.
constexpr Index kMoreAnchors = 8, kMoreErrors = 64;

/// Room for `n` more, all zero.
void grow(MatrixXd& m, Index rows, Index columns) {
  const Index old_rows = m.rows(), old_columns = m.cols();
  m.conservativeResize(rows, columns);
  m.bottomRows(rows - old_rows).setZero();
  m.rightCols(columns - old_columns).setZero();
}

}  // namespace

PoseDrift::PoseDrift(const Calibration& calibration)
    : P_(calibration), to_errors_(kC, 0), last_(MatrixXd::Zero(6, kC)), last_to_errors_(6, 0) {}

Index PoseDrift::row_of(std::uint64_t anchor) const {
  const auto at = std::find(anchors_.begin(), anchors_.end(), anchor);
  return at == anchors_.end() ? -1 : kC + 6 * (at - anchors_.begin());
}

Index PoseDrift::column_of(std::uint64_t error) {
  const auto [at, is_new] = columns_.try_emplace(error, 0);
  if (!is_new) return at->second;
  if (free_columns_.empty()) {
    const Index n = static_cast<Index>(errors_.size());
    for (Index i = kMoreErrors - 1; i >= 0; --i) {
      free_columns_.push_back(static_cast<std::size_t>(n + i));
    }
    errors_.resize(static_cast<std::size_t>(n + kMoreErrors), kNone);
    grow(to_errors_, to_errors_.rows(), 3 * (n + kMoreErrors));
    grow(last_to_errors_, 6, 3 * (n + kMoreErrors));
  }
  const std::size_t place = free_columns_.back();
  free_columns_.pop_back();
  errors_[place] = error;
  at->second = 3 * static_cast<Index>(place);
  return at->second;
}

void PoseDrift::begin(std::uint64_t anchor, const Matrix6d& covariance) {
  const Calibration calibration = P_.topLeftCorner<kC, kC>();
  *this = PoseDrift(calibration);
  last_covariance_ = covariance;
  add(anchor);
}

PoseDrift::Matrix6d PoseDrift::measure(const Measurement& m) {
  std::vector<Index> columns;
  columns.reserve(m.shares.size());
  for (const Share& s : m.shares) columns.push_back(column_of(s.error));

  Matrix6d H = Matrix6d::Zero();
  for (const Reference& r : m.references) H += r.information;
  const Eigen::LDLT<Matrix6d> solver(H);
  // e_C = by_calibration c + by_anchor e_A + by_error x + n
  const Eigen::Matrix<double, 6, kC> by_calibration = -solver.solve(m.by_calibration);
  struct Row {
    Index at;
    Matrix6d gain;
  };
  std::vector<Row> rows;
  for (const Reference& r : m.references) {
    const Index at = row_of(r.anchor);
    if (at >= 0) rows.push_back({at, solver.solve(r.information * adjoint(r.T_CA))});
  }
  last_.noalias() = by_calibration * P_.topRows<kC>();
  last_to_errors_.noalias() = by_calibration * to_errors_.topRows<kC>();
  for (const auto& [at, gain] : rows) {
    last_.noalias() += gain * P_.middleRows<6>(at);
    last_to_errors_.noalias() += gain * to_errors_.middleRows<6>(at);
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Eigen::Matrix<double, 6, 3> gain = solver.solve(m.shares[k].gain);
    last_.noalias() += gain * to_errors_.middleCols<3>(columns[k]).transpose();
    last_to_errors_.middleCols<3>(columns[k]) += gain;
  }
  Matrix6d inherited = last_.leftCols<kC>() * by_calibration.transpose();
  for (const auto& [at, gain] : rows) inherited += last_.middleCols<6>(at) * gain.transpose();
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Eigen::Matrix<double, 6, 3> gain = solver.solve(m.shares[k].gain);
    inherited += last_to_errors_.middleCols<3>(columns[k]) * gain.transpose();
  }
  last_covariance_ = 0.5 * (inherited + inherited.transpose()) + m.noise;
  return last_covariance_;
}

PoseDrift::Matrix6d PoseDrift::since(std::uint64_t anchor, const Eigen::Isometry3d& T_CA) const {
  const Index row = row_of(anchor);
  if (row < 0) return last_covariance_;
  const Matrix6d Ad = adjoint(T_CA);
  const Matrix6d cross = last_.middleCols<6>(row) * Ad.transpose();
  const Matrix6d C =
      last_covariance_ - cross - cross.transpose() + Ad * P_.block<6, 6>(row, row) * Ad.transpose();
  return 0.5 * (C + C.transpose());
}

void PoseDrift::add(std::uint64_t anchor) {
  if (free_rows_.empty()) {
    const Index n = static_cast<Index>(anchors_.size()) + kMoreAnchors;
    for (Index i = n - 1; i >= n - kMoreAnchors; --i) {
      free_rows_.push_back(static_cast<std::size_t>(i));
    }
    anchors_.resize(static_cast<std::size_t>(n), kNone);
    const Index rows = kC + 6 * n;
    grow(P_, rows, rows);
    grow(to_errors_, rows, to_errors_.cols());
    grow(last_, 6, rows);
  }
  const std::size_t place = free_rows_.back();
  free_rows_.pop_back();
  anchors_[place] = anchor;
  const Index at = kC + 6 * static_cast<Index>(place);
  // What is measured from now on is measured from this pose, once more.
  last_.middleCols<6>(at) = last_covariance_;
  P_.middleRows<6>(at) = last_;
  P_.middleCols<6>(at) = last_.transpose();
  to_errors_.middleRows<6>(at) = last_to_errors_;
}

void PoseDrift::fade(const std::vector<std::uint64_t>& errors, double kept) {
  for (const std::uint64_t error : errors) {
    const auto at = columns_.find(error);
    if (at == columns_.end()) continue;
    to_errors_.middleCols<3>(at->second) *= kept;
    last_to_errors_.middleCols<3>(at->second) *= kept;
  }
}

void PoseDrift::keep(const std::vector<std::uint64_t>& anchors,
                     const std::vector<std::uint64_t>& errors) {
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    if (anchors_[i] == kNone || std::binary_search(anchors.begin(), anchors.end(), anchors_[i])) {
      continue;
    }
    anchors_[i] = kNone;
    free_rows_.push_back(i);
    const Index at = kC + 6 * static_cast<Index>(i);
    P_.middleRows<6>(at).setZero();
    P_.middleCols<6>(at).setZero();
    to_errors_.middleRows<6>(at).setZero();
    last_.middleCols<6>(at).setZero();
  }
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    if (errors_[i] == kNone || std::binary_search(errors.begin(), errors.end(), errors_[i])) {
      continue;
    }
    columns_.erase(errors_[i]);
    errors_[i] = kNone;
    free_columns_.push_back(i);
    const Index at = 3 * static_cast<Index>(i);
    to_errors_.middleCols<3>(at).setZero();
    last_to_errors_.middleCols<3>(at).setZero();
  }
}

double PoseDrift::estimate(const Evidence& evidence, double wandered, double most) {
  constexpr Index kZero = kDisparityError;
  P_(kZero, kZero) = std::min(P_(kZero, kZero) + wandered, most);
  // cov(z, s), cov(e_C, s), cov(x, s)
  Eigen::VectorXd of_state = P_.leftCols<kC>() * evidence.by_calibration.transpose();
  Eigen::Matrix<double, 6, 1> of_last = last_.leftCols<kC>() * evidence.by_calibration.transpose();
  std::vector<Index> columns;
  for (const auto& [error, gain] : evidence.errors) columns.push_back(column_of(error));
  Eigen::VectorXd of_errors =
      to_errors_.topRows<kC>().transpose() * evidence.by_calibration.transpose();
  double variance = evidence.noise;
  for (const auto& [anchor, gain] : evidence.anchors) {
    const Index at = row_of(anchor);
    if (at < 0) continue;
    of_state.noalias() += P_.middleCols<6>(at) * gain.transpose();
    of_last.noalias() += last_.middleCols<6>(at) * gain.transpose();
    of_errors.noalias() += to_errors_.middleRows<6>(at).transpose() * gain.transpose();
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Eigen::Vector3d gain = evidence.errors[k].second.transpose();
    of_state.noalias() += to_errors_.middleCols<3>(columns[k]) * gain;
    of_last.noalias() += last_to_errors_.middleCols<3>(columns[k]) * gain;
    of_errors.segment<3>(columns[k]) += gain;
  }
  variance += evidence.by_calibration.dot(of_state.head<kC>());
  for (const auto& [anchor, gain] : evidence.anchors) {
    const Index at = row_of(anchor);
    if (at >= 0) variance += gain.dot(of_state.segment<6>(at));
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    variance += evidence.errors[k].second.dot(of_errors.segment<3>(columns[k]));
  }
  const double shared = of_state[kZero];
  if (!(variance > 0.0) || !(shared > 0.0)) return 0.0;
  const double K = shared / variance;
  const double left = std::max(0.0, P_(kZero, kZero) - K * shared);
  P_.row(kZero) -= K * of_state.transpose();
  P_.col(kZero) = P_.row(kZero).transpose();
  P_(kZero, kZero) = left;
  last_.col(kZero) -= K * of_last;
  to_errors_.row(kZero) -= K * of_errors.transpose();
  return K * evidence.value;
}

}  // namespace prospect
