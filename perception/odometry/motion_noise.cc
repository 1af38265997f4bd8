// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/motion_noise.h"

#include <algorithm>
#include <cmath>

#include "perception/odometry/body_pose.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kLongest = 20, kShortest = 5;  // spans that are measured [frames]
constexpr double kMemory = 100.0;                    // [frames]
constexpr double kForgotten = 0.05;                  // weight below which a claim is dropped
constexpr double kAssumed = 0.01;                    // weight of what is assumed, over all claims
constexpr double kLeastClaims = 5.0;
// Below, a motion is noise of the poses more than way [m], [rad].
constexpr double kLeastMotion = 0.02;
// Of the scale, so that the equations' unknowns are of one size.
constexpr double kScaleUnit = 1e-3;

double square(double x) { return x * x; }

}  // namespace

void MotionNoise::Fit::add(const Vector3d& shares, double ratio) {
  claims_.push_back({shares, ratio, 1.0});
}

double MotionNoise::Fit::fit(Vector3d& x, double f) const {
  // Each step multiplies, so nothing becomes negative, and lowers the sum (Fevotte and Idier 2011).
  constexpr int kSteps = 200;
  constexpr double kDone = 1e-4, kRounding = 1e-9;
  Vector3d up, down;
  for (int step = 0; step < kSteps; ++step) {
    up.setZero();
    down.setZero();
    const auto enter = [&](const Vector3d& shares, double ratio, double weight) {
      const double one_over = weight / shares.dot(x);
      down += one_over * shares;
      up += one_over * ratio / shares.dot(x) * shares;
    };
    for (const Claim& claim : claims_) enter(claim.shares, claim.ratio, claim.weight);
    enter(Vector3d::UnitX(), f, kAssumed * count_);
    enter(Vector3d::UnitY(), f, kAssumed * count_);
    double change = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (!(x[i] > 0.0)) continue;
      const double factor = std::sqrt(up[i] / down[i]);
      x[i] *= factor;
      change = std::max(change, std::abs(factor - 1.0));
    }
    if (change < kDone) break;
  }
  return up[2] - (1.0 + kRounding) * down[2];
}

void MotionNoise::Fit::finish() {
  double ratios = 0.0, along = 0.0, scaled = 0.0;
  count_ = 0.0;
  for (const Claim& claim : claims_) {
    if (claim.shares[2] > 0.0) {
      along += claim.weight * claim.ratio;
      scaled += claim.weight * claim.shares[2];
    } else {
      count_ += claim.weight;
      ratios += claim.weight * claim.ratio;
    }
  }
  if (!(count_ > 0.0)) return;
  const double f = ratios / count_;
  // Without an error of the scale, unless it makes the claims likelier.
  Vector3d x(x_[0] > 0.0 ? x_[0] : f, x_[0] > 0.0 ? x_[1] : f, 0.0);
  const double missed = fit(x, f);
  if (missed > 0.0) {
    constexpr double kLeast = 1e-3;  // of the largest; what has come near zero could not leave it
    const double most = along / scaled;
    x[2] = x_[2] > 0.0 ? std::max(x_[2], kLeast * most) : most;
    fit(x, f);
  }
  x_ = x;
  for (Claim& claim : claims_) claim.weight *= 1.0 - 1.0 / kMemory;
  while (!claims_.empty() && claims_.front().weight < kForgotten) claims_.pop_front();
}

double MotionNoise::claims(const Fits& fits) {
  return std::min(fits.position.count(), fits.yaw.count());
}

void MotionNoise::add(const OdometryFrame& frame, const Odometry& odometry) {
  if (frame.state == Localization::kLost || frame.restarted || frame.tracked == 0) {
    frames_.clear();
    return;
  }
  Frame now{frame.T_WC * T_BC_.inverse(), 0.0, 0.0, static_cast<double>(frame.tracked)};
  if (!frames_.empty()) {
    const Frame& before = frames_.back();
    const Pose step = body_pose(before.T_WB.inverse() * now.T_WB);
    now.driven = before.driven + step.position.norm();
    now.turned = before.turned + std::abs(step.yaw);
    now.tracked += before.tracked;
  }
  frames_.push_back(now);
  if (frames_.size() > kLongest + 1) frames_.pop_front();
  if (frame.keyframe && claims(measured_) < kLeastClaims) enter_ahead(odometry);
  const std::size_t all = frames_.size() - 1;
  if (all < kShortest) return;
  enter_since(kShortest, odometry);
  if (all > kShortest) enter_since(all, odometry);
  measured_.position.finish();
  measured_.yaw.finish();
}

void MotionNoise::enter_since(std::size_t span, const Odometry& odometry) {
  const std::optional<Matrix6d> claimed = odometry.covariance_since(static_cast<int>(span));
  if (!claimed) return;
  const Frame &now = frames_.back(), &then = frames_[frames_.size() - 1 - span];
  Frame over{then.T_WB.inverse() * now.T_WB, now.driven - then.driven, now.turned - then.turned,
             (now.tracked - then.tracked) / static_cast<double>(span)};
  if (over.driven + over.turned > kLeastMotion) enter(measured_, over, *claimed);
}

void MotionNoise::enter_ahead(const Odometry& odometry) {
  const std::optional<MotionAhead> ahead = odometry.motion_ahead();
  if (!ahead) return;
  ahead_ = {};
  const Isometry3d T_BB = T_BC_ * ahead->T_CC * T_BC_.inverse();
  const Pose step = body_pose(T_BB);
  const Frame over{T_BB, step.position.norm(), std::abs(step.yaw),
                   static_cast<double>(ahead->tracked)};
  enter(ahead_, over, ahead->covariance);
  ahead_.position.finish();
  ahead_.yaw.finish();
}

void MotionNoise::enter(Fits& fits, const Frame& over, const Matrix6d& claimed) const {
  const double fewer =
      (assumed_.reference_count + assumed_.floor_count) / (over.tracked + assumed_.floor_count);
  const Eigen::Matrix4d C = body_covariance(over.T_WB * T_BC_, T_BC_, claimed);
  const Vector2d d = over.T_WB.translation().head<2>();
  const double squared = d.squaredNorm(), both = C(0, 0) + C(1, 1);
  const double along = squared > 0.0 ? d.dot(C.topLeftCorner<2, 2>() * d) / squared : 0.5 * both;
  const auto add = [&](Fit& fit, double variance, double per_metre, double per_radian,
                       double scaled) {
    const double driven = fewer * square(per_metre) * over.driven;
    const double turned = fewer * square(per_radian) * over.turned;
    const double m = driven + turned;
    if (!(m > 0.0) || !(variance > 0.0) || !std::isfinite(variance)) return;
    fit.add(Vector3d(driven, turned, square(kScaleUnit) * scaled) / m, variance / m);
  };
  add(fits.position, along, assumed_.position_per_metre, assumed_.position_per_radian, squared);
  add(fits.position, both - along, assumed_.position_per_metre, assumed_.position_per_radian, 0.0);
  add(fits.yaw, C(3, 3), assumed_.yaw_per_metre, assumed_.yaw_per_radian, 0.0);
}

std::optional<OdometryNoise> MotionNoise::noise() const {
  OdometryNoise noise = assumed_;
  if (claims(measured_) < kLeastClaims) {
    if (!(claims(ahead_) > 0.0)) return std::nullopt;
    // One motion shows what the calibration leaves to the scale, not how errors walk.
    noise.scale = kScaleUnit * std::sqrt(ahead_.position.solved()[2]);
    return noise;
  }
  const Vector3d &position = measured_.position.solved(), &yaw = measured_.yaw.solved();
  noise.position_per_metre *= std::sqrt(position[0]);
  noise.position_per_radian *= std::sqrt(position[1]);
  noise.scale = kScaleUnit * std::sqrt(position[2]);
  noise.yaw_per_metre *= std::sqrt(yaw[0]);
  noise.yaw_per_radian *= std::sqrt(yaw[1]);
  return noise;
}

}  // namespace prospect
