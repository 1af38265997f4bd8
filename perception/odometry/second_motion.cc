// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/second_motion.h"

#include <algorithm>
#include <cmath>

#include "perception/odometry/se3.h"

namespace prospect {
namespace {

/// Logarithm of the odds that of two things in view the nearer one moves.
constexpr double kNearerMoves = 2.2;
/// Ratio of depths from which on one is the nearer.
constexpr double kNearer = 1.1;

double motion_likelihood(const MotionHypothesis& h, const MotionExpectation& expected) {
  if (expected.prior == nullptr) return 0.0;
  return expected.prior->log_likelihood(log_se3(h.T_CW * expected.T_CW.inverse()), expected.dt);
}

SecondMotion::Matrix6d of_unknown(double time) {
  const double way = SecondMotion::kUnknownSpeed * time, turn = SecondMotion::kUnknownTurn * time;
  SecondMotion::Vector6d variances;
  variances << Eigen::Vector3d::Constant(way * way), Eigen::Vector3d::Constant(turn * turn);
  return variances.asDiagonal();
}

}  // namespace

double world_log_odds(const MotionHypothesis& a, const MotionHypothesis& b,
                      const MotionExpectation& expected) {
  const double share = 2.0 * std::log(static_cast<double>(std::max(a.cells, 1)) /
                                      static_cast<double>(std::max(b.cells, 1)));
  double depth = 0.0;
  if (a.depth > kNearer * b.depth) depth = kNearerMoves;
  if (b.depth > kNearer * a.depth) depth = -kNearerMoves;
  return share + depth + motion_likelihood(a, expected) - motion_likelihood(b, expected);
}

void SecondMotion::begin(const Eigen::Isometry3d& before_T_CW, double stamp,
                         const std::optional<Vector6d>& velocity, double log_odds) {
  end();
  live_ = true;
  probability_ = 1.0 / (1.0 + std::exp(log_odds));
  T_CW_ = before_T_CW;
  stamp_ = stamp;
  velocity_ = velocity;
}

void SecondMotion::see(const Eigen::Isometry3d& T_CW, const Eigen::Isometry3d& other_T_CW,
                       double stamp) {
  velocity_ = log_se3(other_T_CW * T_CW_.inverse()) / std::max(stamp - stamp_, 1e-3);
  T_CW_ = other_T_CW;
  stamp_ = stamp;
  newest_ = std::sqrt(probability_) * log_se3(T_CW.inverse() * other_T_CW);
}

void SecondMotion::end() {
  ended_ += newest_ * newest_.transpose();
  ended_sum_ += newest_;
  newest_.setZero();
  live_ = false;
}

std::optional<Eigen::Isometry3d> SecondMotion::expected(double stamp) const {
  if (!live_) return std::nullopt;
  if (!velocity_) return T_CW_;
  return exp_se3(*velocity_ * (stamp - stamp_)) * T_CW_;
}

SecondMotion::Matrix6d SecondMotion::covariance(const Eigen::Isometry3d& T_CW) const {
  const Matrix6d Ad = adjoint(T_CW);
  return Ad * (ended_ + newest_ * newest_.transpose()) * Ad.transpose() + of_unknown(unknown_);
}

SecondMotion::Matrix6d SecondMotion::covariance_since(const Sum& then,
                                                      const Eigen::Isometry3d& T_CW) const {
  const Vector6d known = adjoint(T_CW) * (sum().known - then.known);
  return known * known.transpose() + of_unknown(unknown_ - then.unknown);
}

}  // namespace prospect
