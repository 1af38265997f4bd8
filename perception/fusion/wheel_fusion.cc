// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/wheel_fusion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "engine/support/cholesky.h"
#include "models/knobs.h"
#include "models/parameter_check.h"
#include "models/reason.h"
#include "models/sinc.h"

namespace prospect {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix36d = Eigen::Matrix<double, 3, 6>;

// Where the parts of the state begin.
constexpr int kReference = 0, kMotion = 3, kScale = 6, kTurnScale = 7;

Matrix2d rotation(double angle) {
  Matrix2d R;
  R << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return R;
}

/// d rotation(a) / da = rotation(a) kTurn.
const Matrix2d kTurn = (Matrix2d() << 0.0, -1.0, 1.0, 0.0).finished();

double wrapped(double angle) { return std::remainder(angle, 2.0 * M_PI); }

/// The motion a, then b.
Vector3d composed(const Vector3d& a, const Vector3d& b) {
  Vector3d c;
  c << a.head<2>() + rotation(a[2]) * b.head<2>(), a[2] + b[2];
  return c;
}

/// d composed(a, b) / d(a, b).
Matrix36d composed_jacobian(const Vector3d& a, const Vector3d& b) {
  Matrix36d J = Matrix36d::Zero();
  J.leftCols<3>().setIdentity();
  J.topRightCorner<3, 3>().setIdentity();
  J.block<2, 1>(0, 2) = rotation(a[2]) * kTurn * b.head<2>();
  J.block<2, 2>(0, 3) = rotation(a[2]);
  return J;
}

Matrix3d composed_covariance(const Vector3d& a, const Matrix3d& A, const Vector3d& b,
                             const Matrix3d& B) {
  const Matrix36d J = composed_jacobian(a, b);
  return J.leftCols<3>() * A * J.leftCols<3>().transpose() +
         J.rightCols<3>() * B * J.rightCols<3>().transpose();
}

/// The way back: composed(inverse(a), a) = 0.
Vector3d inverse(const Vector3d& a) {
  Vector3d back;
  back << -(rotation(-a[2]) * a.head<2>()), -a[2];
  return back;
}

/// Its covariance, if A is that of a.
Matrix3d inverse_covariance(const Vector3d& a, const Matrix3d& A) {
  Matrix3d J = -Matrix3d::Identity();
  J.topLeftCorner<2, 2>() = -rotation(-a[2]);
  J.topRightCorner<2, 1>() = rotation(-a[2]) * kTurn * a.head<2>();
  return J * A * J.transpose();
}

/// The larger eigenvalue of the covariance of a position.
double largest_variance(const Matrix2d& C) {
  const double mean = 0.5 * (C(0, 0) + C(1, 1));
  return mean + std::hypot(0.5 * (C(0, 0) - C(1, 1)), C(0, 1));
}

// What no robot on wheels does: beyond these, numbers are faults.
constexpr double kFastest = 100.0;       // [m/s, rad/s]
constexpr double kFarthestMotion = 1e4;  // [m] from a keyframe
constexpr double kLongest = 3600.0;      // [s] without a word

/// Symmetric, finite and positive definite.
bool is_covariance(const Matrix3d& C) {
  if (!(C.norm() <= kFarthestMotion * kFarthestMotion) ||
      (C - C.transpose()).norm() > 1e-9 * (1.0 + C.norm()))
    return false;
  const Eigen::LLT<Matrix3d> factor(C);
  return factor.info() == Eigen::Success;
}

}  // namespace

WheelFusion::WheelFusion(const WheelFusionOptions& options) : options_(options) {
  const char* const owner = "wheel fusion";
  check_knobs(owner, options);
  check_parameter(options.start.position.allFinite() && std::isfinite(options.start.yaw), owner,
                  "start", options.start.yaw, "a finite pose");
  x_.segment<3>(kReference) << options.start.position.head<2>(), options.start.yaw;
  x_[kScale] = x_[kTurnScale] = 1.0;
  P_(kScale, kScale) = P_(kTurnScale, kTurnScale) =
      options.noise.sigma_scale * options.noise.sigma_scale;
}

void WheelFusion::begin(double stamp) {
  if (started_) return;
  started_ = true;
  stamp_ = fix_stamp_ = stamp;
  take_reference();
}

void WheelFusion::take_reference() {
  variance_at_fix_ -= motion_variance();
  const Vector3d r = x_.segment<3>(kReference), m = x_.segment<3>(kMotion);
  Covariance J = Covariance::Identity();
  J.block<3, 6>(kReference, kReference) = composed_jacobian(r, m);
  J.block<3, 3>(kMotion, kMotion).setZero();
  x_.segment<3>(kReference) = composed(r, m);
  x_.segment<3>(kMotion).setZero();
  P_ = (J * P_ * J.transpose()).eval();
  detour_.setZero();
  detour_covariance_.setZero();
  unsure_detour_ = false;
}

Vector3d WheelFusion::pose() const {
  return composed(x_.segment<3>(kReference), x_.segment<3>(kMotion));
}

double WheelFusion::motion_variance() const {
  return largest_variance(P_.block<2, 2>(kMotion, kMotion));
}

void WheelFusion::move(const Vector2d& velocity, double yaw_rate, double dt) {
  const double s = x_[kScale], r = x_[kTurnScale];
  const Vector2d v = s * velocity;
  const double w = r * yaw_rate, phi = 0.5 * w * dt;
  const Matrix2d R = rotation(x_[kMotion + 2] + phi);
  const double d = dt * sinc(phi);
  const Vector2d d_psi = d * R * kTurn * v;
  const Vector2d d_w = 0.5 * dt * (dt * sinc_derivative(phi) * R * v + d_psi);
  Covariance F = Covariance::Identity();
  F.block<2, 1>(kMotion, kMotion + 2) = d_psi;
  F.block<2, 1>(kMotion, kScale) = d * R * velocity;
  F.block<2, 1>(kMotion, kTurnScale) = d_w * yaw_rate;
  F(kMotion + 2, kTurnScale) = yaw_rate * dt;

  const double way = v.norm() * dt, turn = std::abs(w) * dt;
  // Along and across the direction of driving; the yaw's error acts on the second half of the way.
  Matrix2d axes = Matrix2d::Identity();
  if (way > 0.0) axes << v / v.norm(), kTurn * v / v.norm();
  const Vector2d variance(options_.noise.along * options_.noise.along * way,
                          options_.noise.across * options_.noise.across * way);
  const double yaw_variance = options_.noise.turn * options_.noise.turn * turn +
                              options_.noise.heading * options_.noise.heading * way;
  Eigen::Matrix<double, 3, 3> G = Matrix3d::Identity();
  G.topLeftCorner<2, 2>() = R * axes;
  G.topRightCorner<2, 1>() = 0.5 * d_psi;

  x_.segment<2>(kMotion) += d * R * v;
  x_[kMotion + 2] += w * dt;
  const double turned = yaw_rate * dt;
  const Vector2d straight = dt * sinc(0.5 * turned) * rotation(0.5 * turned) * velocity;
  piece_by_wheels_ = composed(piece_by_wheels_, {straight.x(), straight.y(), turned});
  P_ = (F * P_ * F.transpose()).eval();
  P_.block<3, 3>(kMotion, kMotion) +=
      G * Vector3d(variance.x(), variance.y(), yaw_variance).asDiagonal() * G.transpose();
  P_(kScale, kScale) += options_.scale_walk * options_.scale_walk * way;
  P_(kTurnScale, kTurnScale) += options_.scale_walk * options_.scale_walk * turn;
  P_ = (0.5 * (P_ + P_.transpose())).eval();
}

void WheelFusion::drift(double dt) {
  piece_known_ = false;
  P_.block<3, 3>(kMotion, kMotion).diagonal().array() +=
      options_.unknown_speed * options_.unknown_speed * dt;
}

void WheelFusion::advance(double stamp) {
  while (stamp_ < stamp) {
    // The sample whose time stamp_ lies in: the first one after it.
    const auto next = std::find_if(wheels_.begin(), wheels_.end(),
                                   [&](const WheelSample& w) { return w.stamp > stamp_; });
    double until = stamp;
    if (next == wheels_.end()) {
      // Nothing told yet: as before for a while, then no one knows.
      const double last = wheels_.empty() ? stamp_ : wheels_.back().stamp;
      const double known = wheels_.empty() ? stamp_ : last + options_.max_wheel_gap;
      if (stamp_ < known) {
        until = std::min(stamp, known);
        move(wheels_.back().velocity, wheels_.back().yaw_rate, until - stamp_);
      } else {
        drift(until - stamp_);
      }
    } else {
      until = std::min(stamp, next->stamp);
      const bool gap =
          next == wheels_.begin() || next->stamp - std::prev(next)->stamp > options_.max_wheel_gap;
      move(next->velocity, next->yaw_rate, until - stamp_);
      if (gap) drift(until - stamp_);
    }
    stamp_ = until;
  }
  while (wheels_.size() >= 2 && wheels_[1].stamp <= stamp_) wheels_.pop_front();
}

bool WheelFusion::add(const WheelSample& sample) {
  if (!std::isfinite(sample.stamp) || !(sample.velocity.norm() <= kFastest) ||
      !(std::abs(sample.yaw_rate) <= kFastest)) {
    left_out_ = "a wheel sample is not possible";
    return false;
  }
  if (started_ && sample.stamp - stamp_ > kLongest) {
    left_out_ = "the time of the wheels jumps";
    return false;
  }
  if (!wheels_.empty() && !(sample.stamp > wheels_.back().stamp)) {
    left_out_ = "the time of the wheels does not increase";
    return false;
  }
  begin(sample.stamp);
  has_wheels_ = true;
  wheels_.push_back(sample);
  work_in_waiting(sample.stamp);
  // Up to a sample, where the next step begins anyway: so a late frame finds the same steps.
  const auto waits = std::find_if(wheels_.rbegin(), wheels_.rend(), [&](const WheelSample& w) {
    return w.stamp <= sample.stamp - options_.max_wait;
  });
  if (waits != wheels_.rend()) advance(waits->stamp);
  return true;
}

void WheelFusion::add(const VisualMotion& visual) {
  if (!std::isfinite(visual.stamp)) {
    left_out_ = "the time of a visual frame is not a number";
    return;
  }
  if (!(visual.scale_sigma >= 0.0 && std::isfinite(visual.scale_sigma))) {
    left_out_ = "the scale of visual odometry has no standard deviation";
    return;
  }
  if (has_visual_ && !(visual.stamp > newest_visual_)) {
    left_out_ = "the time of visual odometry does not increase";
    return;
  }
  if (started_ && visual.stamp - stamp_ > kLongest) {
    left_out_ = "the time of visual odometry jumps";
    return;
  }
  begin(visual.stamp);
  if (visual.stamp < stamp_) {
    left_out_ = "a visual frame came too late";
    return;
  }
  has_visual_ = true;
  newest_visual_ = visual.stamp;
  waiting_.push_back(visual);
  work_in_waiting(wheels_.empty() ? visual.stamp : wheels_.back().stamp);
}

void WheelFusion::work_in_waiting(double known) {
  while (!waiting_.empty()) {
    const VisualMotion& first = waiting_.front();
    // Wheels that are silent for long are not waited for.
    if (has_wheels_ && first.stamp > known &&
        newest_visual_ - first.stamp <= options_.max_wheel_gap) {
      return;
    }
    work_in(first);
    waiting_.pop_front();
  }
}

void WheelFusion::compare(const VisualMotion& visual) {
  constexpr double kMostTurn = 1.5;  // [rad]: beyond, lines depend on how turns are measured
  constexpr double kNoScale = 5.0;
  piece_by_vision_ = composed(piece_by_vision_, visual.motion);
  scale_sigma_ = visual.scale_sigma;
  const double by_wheels = piece_by_wheels_.head<2>().norm();
  const bool usable = piece_known_ && !visual.begins_map && piece_by_vision_.allFinite() &&
                      std::abs(piece_by_wheels_[2]) <= kMostTurn;
  if (usable && by_wheels < options_.piece) return;
  const double ratio = piece_by_vision_.head<2>().norm() / by_wheels;
  if (usable && ratio < kNoScale && ratio > 1.0 / kNoScale) {
    log_ratios_.push_back(std::log(ratio));
    while (static_cast<int>(log_ratios_.size()) > options_.pieces) log_ratios_.pop_front();
  }
  piece_by_wheels_.setZero();
  piece_by_vision_.setZero();
  piece_known_ = has_wheels_;
}

void WheelFusion::work_in(const VisualMotion& visual) {
  advance(visual.stamp);
  if (visual.begins_map || (visual.state != Localization::kLost && visual.becomes_reference)) {
    compare(visual);
  }
  correction_ = 0.0;
  contradicted_ = false;
  visual_ = visual.state;
  visual_reason_.clear();
  if (visual.begins_map) {
    take_reference();
    beyond_gate_ = 0;
    if (has_reference_) {
      visual_reason_ = "a new visual map begins";
      if (visual_ == Localization::kOk) visual_ = Localization::kDegraded;
    } else if (visual_ == Localization::kDegraded) {
      visual_reason_ = "visual odometry is degraded";
    }
    has_reference_ = true;
    return;
  }
  if (visual.state == Localization::kLost) {
    visual_reason_ = "visual odometry is lost";
    return;
  }
  if (!(visual.motion.norm() <= kFarthestMotion) || !is_covariance(visual.covariance)) {
    visual_ = Localization::kLost;
    visual_reason_ = "a visual motion is not possible";
    return;
  }
  if (!has_reference_) {
    // The frame that began the map was left out, as the wheels spoke first: it is this one.
    take_reference();
    has_reference_ = true;
    visual_ = Localization::kDegraded;
    visual_reason_ = "a new visual map begins";
    if (visual.becomes_reference) return;
    detour_ = inverse(visual.motion);
    detour_covariance_ = inverse_covariance(visual.motion, visual.covariance);
    return;
  }
  // Since the filter's reference, if one came in between that was not taken.
  const Vector3d measured = composed(detour_, visual.motion);
  const Matrix3d noise =
      composed_covariance(detour_, detour_covariance_, visual.motion, visual.covariance);
  const Vector3d before = pose();
  Vector3d innovation = measured - x_.segment<3>(kMotion);
  innovation[2] = wrapped(innovation[2]);
  const Matrix3d S = P_.block<3, 3>(kMotion, kMotion) + noise;
  const Eigen::LDLT<Matrix3d> factor(S);
  chi2_ = innovation.dot(factor.solve(innovation));
  if (!(chi2_ <= options_.gate)) {
    const bool often = ++beyond_gate_ >= options_.slips;
    const bool sure = visual.state == Localization::kOk;
    if (!often || !sure) {
      visual_ = Localization::kDegraded;
      visual_reason_ = "wheels and vision disagree";
      contradicted_ = often;
      // Who is right is not known yet: a reference of the wheels' making would settle it.
      if (visual.becomes_reference) {
        detour_ = measured;
        detour_covariance_ = noise;
        unsure_detour_ = unsure_detour_ || !sure;
      }
      return;
    }
    // From vision alone.
    x_.segment<3>(kMotion) += innovation;
    P_.middleRows<3>(kMotion).setZero();
    P_.middleCols<3>(kMotion).setZero();
    P_.block<3, 3>(kMotion, kMotion) = noise;
    // Of two that may be right, as likely as each other, it is one: the covariance covers both.
    if (unsure_detour_) {
      P_.block<3, 3>(kMotion, kMotion) += 0.5 * innovation * innovation.transpose();
    }
    visual_ = Localization::kDegraded;
    visual_reason_ = "the wheels have slipped";
  } else {
    const Eigen::Matrix<double, 8, 3> K = factor.solve(P_.middleRows<3>(kMotion)).transpose();
    x_ += K * innovation;
    Covariance I_KH = Covariance::Identity();
    I_KH.middleCols<3>(kMotion) -= K;
    P_ = (I_KH * P_ * I_KH.transpose() + K * noise * K.transpose()).eval();
    if (visual_ == Localization::kDegraded) visual_reason_ = "visual odometry is degraded";
    beyond_gate_ = 0;
  }
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  correction_ = (pose() - before).head<2>().norm();
  variance_at_fix_ = motion_variance();
  fix_stamp_ = visual.stamp;
  left_out_.clear();
  if (visual.becomes_reference) {
    take_reference();
    beyond_gate_ = 0;
  }
}

FusedOdometry WheelFusion::at(double stamp) const {
  FusedOdometry out;
  out.stamp = std::isfinite(stamp) ? std::max(stamp, stamp_) : stamp_;
  WheelFusion now = *this;
  while (!now.waiting_.empty() && now.waiting_.front().stamp <= out.stamp) {
    now.work_in(now.waiting_.front());
    now.waiting_.pop_front();
  }
  now.advance(out.stamp);
  out.newest = now.has_visual_ ? now.newest_visual_ : 0.0;
  if (!now.wheels_.empty()) out.newest = std::max(out.newest, now.wheels_.back().stamp);
  const Vector3d pose = now.pose();
  out.pose = {{pose.x(), pose.y(), 0.0}, pose[2]};
  const Matrix36d J = composed_jacobian(now.x_.segment<3>(kReference), now.x_.segment<3>(kMotion));
  out.covariance = J * now.P_.topLeftCorner<6, 6>() * J.transpose();
  out.scale = now.x_[kScale];
  out.turn_scale = now.x_[kTurnScale];
  out.sigma_scale = std::sqrt(now.P_(kScale, kScale));
  out.sigma_turn_scale = std::sqrt(now.P_(kTurnScale, kTurnScale));
  out.chi2 = now.chi2_;
  out.correction = now.correction_;
  if (!now.started_) {
    out.covariance.setZero();
    out.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
    out.reason = "nothing is measured yet";
    return out;
  }
  out.state = now.visual_ == Localization::kOk ? Localization::kOk : Localization::kDegraded;
  out.reason = now.visual_reason_;
  const double silent = out.stamp - now.newest_visual_;
  if (now.has_visual_ && silent > options_.max_wait) {
    add_reason(out.reason, "visual odometry is silent");
    out.state = Localization::kDegraded;
  }
  const bool wheels_known =
      !now.wheels_.empty() && out.stamp - now.wheels_.back().stamp <= options_.max_wheel_gap;
  if (wheels_known) {
    const WheelSample& newest = now.wheels_.back();
    out.twist.linear << out.scale * newest.velocity, 0.0;
    out.twist.yaw_rate = out.turn_scale * newest.yaw_rate;
  } else {
    add_reason(out.reason, "no wheel odometry");
    out.state = Localization::kDegraded;
  }
  if (!now.left_out_.empty()) {
    add_reason(out.reason, now.left_out_);
    out.state = Localization::kDegraded;
  }
  // Of a piece by the wheels: along sqrt(piece) of the piece.
  out.agreement =
      scale_agreement({now.log_ratios_.begin(), now.log_ratios_.end()},
                      options_.noise.along / std::sqrt(options_.piece),
                      std::hypot(options_.noise.sigma_scale, now.scale_sigma_), options_.agreement);
  if (out.agreement.verdict == ScaleAgreement::Verdict::kDisagree) {
    add_reason(out.reason, to_string(out.agreement, "the way by vision is", "that by the wheels") +
                               ": one of them is calibrated wrongly");
    out.state = Localization::kLost;
  }
  if (now.contradicted_) out.state = Localization::kLost;
  const double since = now.motion_variance() - now.variance_at_fix_;
  if (since > options_.max_dead_reckoning * options_.max_dead_reckoning) {
    add_reason(out.reason, "too far by dead reckoning");
    out.state = Localization::kLost;
  }
  return out;
}

}  // namespace prospect
