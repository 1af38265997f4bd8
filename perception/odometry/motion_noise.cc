#include "perception/odometry/motion_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "perception/odometry/body_pose.h"

namespace prospect {
namespace {

constexpr std::size_t kLongest = 20, kShortest = 5;  // spans that are measured [frames]
constexpr double kMemory = 100.0;                    // [frames]
constexpr double kAssumed = 0.05;                    // weight of what is assumed, over all claims
constexpr double kLeastClaims = 5.0;
// Below, a motion is noise of the poses more than way [m], [rad].
constexpr double kLeastMotion = 0.02;

double square(double x) { return x * x; }

}  // namespace

void MotionNoise::Sums::add(double ratio, double driven_share) {
  count += 1.0;
  r += ratio;
  r_driven += ratio * driven_share;
  driven += driven_share;
  driven_squared += square(driven_share);
}

void MotionNoise::Sums::forget() {
  for (double* sum : {&count, &r, &r_driven, &driven, &driven_squared}) {
    *sum *= 1.0 - 1.0 / kMemory;
  }
}

std::pair<double, double> MotionNoise::Sums::factors() const {
  const double f = r / count;
  // The share of turning is one less that of driving.
  const double turned_squared = count - 2.0 * driven + driven_squared;
  const double both = driven - driven_squared;
  const double prior = kAssumed * count;
  const double uu = driven_squared + prior, vv = turned_squared + prior;
  const double bu = r_driven / f + prior, bv = (r - r_driven) / f + prior;
  const double determinant = uu * vv - both * both;  // > 0 by the prior
  double u = (vv * bu - both * bv) / determinant, v = (uu * bv - both * bu) / determinant;
  if (u < 0.0) {
    u = 0.0;
    v = bv / vv;
  } else if (v < 0.0) {
    v = 0.0;
    u = bu / uu;
  }
  return {f * u, f * v};
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
  const std::size_t span = frames_.size() - 1;
  if (span < kShortest) return;
  const std::optional<Eigen::Matrix<double, 6, 6>> claimed =
      odometry.covariance_since(static_cast<int>(span));
  if (!claimed) return;

  const Frame& then = frames_.front();
  const double s = now.driven - then.driven, a = now.turned - then.turned;
  if (!(s + a > kLeastMotion)) return;
  const double N = (now.tracked - then.tracked) / static_cast<double>(span);
  const double fewer =
      (assumed_.reference_count + assumed_.floor_count) / (N + assumed_.floor_count);
  // In B then.
  const Eigen::Matrix4d C =
      body_covariance(then.T_WB.inverse() * now.T_WB * T_BC_, T_BC_, *claimed);
  const auto enter = [&](Sums& sums, double variance, double per_metre, double per_radian) {
    const double driven = square(per_metre) * s, turned = square(per_radian) * a;
    if (!(driven + turned > 0.0) || !(variance > 0.0) || !std::isfinite(variance)) return;
    sums.forget();
    sums.add(variance / (fewer * (driven + turned)), driven / (driven + turned));
  };
  enter(position_, 0.5 * (C(0, 0) + C(1, 1)), assumed_.position_per_metre,
        assumed_.position_per_radian);
  enter(yaw_, C(3, 3), assumed_.yaw_per_metre, assumed_.yaw_per_radian);
}

std::optional<OdometryNoise> MotionNoise::noise() const {
  if (std::min(position_.count, yaw_.count) < kLeastClaims) return std::nullopt;
  OdometryNoise noise = assumed_;
  const auto position = position_.factors(), yaw = yaw_.factors();
  noise.position_per_metre *= std::sqrt(position.first);
  noise.position_per_radian *= std::sqrt(position.second);
  noise.yaw_per_metre *= std::sqrt(yaw.first);
  noise.yaw_per_radian *= std::sqrt(yaw.second);
  return noise;
}

}  // namespace prospect
