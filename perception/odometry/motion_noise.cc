// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/motion_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "engine/support/cholesky.h"
#include "perception/odometry/body_pose.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kLongest = 20, kShortest = 5;  // spans that are measured [frames]
constexpr double kMemory = 100.0;                    // [frames]
constexpr double kAssumed = 0.01;                    // weight of what is assumed, over all claims
constexpr double kLeastClaims = 5.0;
// Below, a motion is noise of the poses more than way [m], [rad].
constexpr double kLeastMotion = 0.02;
// Of the scale, so that the equations' unknowns are of one size.
constexpr double kScaleUnit = 1e-3;

double square(double x) { return x * x; }

/// The x >= 0 that minimises x^T A x / 2 - b^T x, by trying all sets of what is not zero. A:
/// positive semi-definite; of zero where its diagonal is.
Vector3d least_squares_not_negative(const Matrix3d& A, const Vector3d& b) {
  Vector3d best = Vector3d::Zero();
  double lowest = 0.0;
  for (int set = 1; set < 8; ++set) {
    Matrix3d of_set = A;
    Vector3d right = b;
    bool fixed = true;
    for (int i = 0; i < 3; ++i) {
      if (set >> i & 1) {
        fixed = fixed && A(i, i) > 0.0;
      } else {
        of_set.row(i).setZero();
        of_set.col(i).setZero();
        of_set(i, i) = 1.0;
        right[i] = 0.0;
      }
    }
    if (!fixed) continue;
    const Vector3d x = of_set.ldlt().solve(right);
    if (!x.allFinite() || x.minCoeff() < 0.0) continue;
    const double cost = 0.5 * x.dot(A * x) - b.dot(x);
    if (cost < lowest) {
      lowest = cost;
      best = x;
    }
  }
  return best;
}

}  // namespace

void MotionNoise::Fit::add(const Vector3d& shares, double ratio) {
  normal += shares * shares.transpose();
  right += shares * ratio;
  if (shares[2] > 0.0) return;
  count += 1.0;
  ratios += ratio;
}

void MotionNoise::Fit::forget() {
  constexpr double kKept = 1.0 - 1.0 / kMemory;
  normal *= kKept;
  right *= kKept;
  count *= kKept;
  ratios *= kKept;
}

Vector3d MotionNoise::Fit::solved() const {
  Matrix3d A = normal;
  Vector3d b = right;
  for (int i = 0; i < 2; ++i) {
    A(i, i) += kAssumed * count;
    b[i] += kAssumed * ratios;
  }
  return least_squares_not_negative(A, b);
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
  const std::size_t all = frames_.size() - 1;
  if (all < kShortest) return;
  position_.forget();
  yaw_.forget();
  enter(kShortest, odometry);
  if (all > kShortest) enter(all, odometry);
}

void MotionNoise::enter(std::size_t span, const Odometry& odometry) {
  const std::optional<Eigen::Matrix<double, 6, 6>> claimed =
      odometry.covariance_since(static_cast<int>(span));
  if (!claimed) return;
  const Frame &now = frames_.back(), &then = frames_[frames_.size() - 1 - span];
  const double s = now.driven - then.driven, a = now.turned - then.turned;
  if (!(s + a > kLeastMotion)) return;
  const double N = (now.tracked - then.tracked) / static_cast<double>(span);
  const double fewer =
      (assumed_.reference_count + assumed_.floor_count) / (N + assumed_.floor_count);
  // In B then.
  const Isometry3d motion = then.T_WB.inverse() * now.T_WB;
  const Eigen::Matrix4d C = body_covariance(motion * T_BC_, T_BC_, *claimed);
  const Vector2d d = motion.translation().head<2>();
  const double squared = d.squaredNorm(), both = C(0, 0) + C(1, 1);
  const double along = squared > 0.0 ? d.dot(C.topLeftCorner<2, 2>() * d) / squared : 0.5 * both;
  const auto add = [&](Fit& fit, double variance, double per_metre, double per_radian,
                       double scaled) {
    const double driven = fewer * square(per_metre) * s, turned = fewer * square(per_radian) * a;
    const double m = driven + turned;
    if (!(m > 0.0) || !(variance > 0.0) || !std::isfinite(variance)) return;
    fit.add(Vector3d(driven, turned, square(kScaleUnit) * scaled) / m, variance / m);
  };
  add(position_, along, assumed_.position_per_metre, assumed_.position_per_radian, squared);
  add(position_, both - along, assumed_.position_per_metre, assumed_.position_per_radian, 0.0);
  add(yaw_, C(3, 3), assumed_.yaw_per_metre, assumed_.yaw_per_radian, 0.0);
}

std::optional<OdometryNoise> MotionNoise::noise() const {
  if (std::min(position_.count, yaw_.count) < kLeastClaims) return std::nullopt;
  OdometryNoise noise = assumed_;
  const Vector3d position = position_.solved(), yaw = yaw_.solved();
  noise.position_per_metre *= std::sqrt(position[0]);
  noise.position_per_radian *= std::sqrt(position[1]);
  noise.scale = kScaleUnit * std::sqrt(position[2]);
  noise.yaw_per_metre *= std::sqrt(yaw[0]);
  noise.yaw_per_radian *= std::sqrt(yaw[1]);
  return noise;
}

}  // namespace prospect
