// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/imu_integral.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace prospect {
namespace {

constexpr double kFastestTurn = 100.0;  // [rad/s]
constexpr double kMostForce = 1000.0;   // [m/s^2]
constexpr double kLeastForce = 1.0;  // [m/s^2] below it nothing is measured, or all is in free fall
constexpr std::size_t kMostSamples = 10000;

Eigen::Quaterniond turned(const Eigen::Vector3d& angle) {
  const double a = angle.norm();
  if (a < 1e-12) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(a, angle / a));
}

}  // namespace

std::string ImuIntegral::add(const ImuSample& sample) {
  if (!std::isfinite(sample.stamp) || !sample.finite()) return "a number that is not finite";
  if (!(sample.angular_velocity.norm() <= kFastestTurn)) return "a turn of more than 100 rad/s";
  if (!(sample.linear_acceleration.norm() <= kMostForce)) return "a force of more than 1000 m/s2";
  const double length = sample.R_BS.norm();
  if (!(length > 0.5 && length < 2.0)) return "axes that are no rotation";
  const bool repeats = newest_ && sample.angular_velocity == newest_->angular_velocity &&
                       sample.linear_acceleration == newest_->linear_acceleration;
  newest_ = sample;
  if (repeats) return "it repeats the sample before: the sensor hangs";
  if (!samples_.empty() && !(sample.stamp > samples_.back().stamp)) {
    return "not newer than the sample before";
  }
  const Eigen::Quaterniond R_BS = sample.R_BS.normalized();
  samples_.push_back(
      {sample.stamp, R_BS * sample.angular_velocity, R_BS * sample.linear_acceleration});
  while (samples_.size() > kMostSamples ||
         (samples_.size() > 2 && samples_[1].stamp < sample.stamp - keep_)) {
    samples_.pop_front();
  }
  return {};
}

std::optional<ImuMotion> ImuIntegral::between(double from, double until,
                                              const Eigen::Vector3d& bias) const {
  if (samples_.empty() || !(until > from)) return std::nullopt;
  // The first sample after `from`, and the one before it.
  auto next = std::upper_bound(samples_.begin(), samples_.end(), from,
                               [](double t, const Sample& s) { return t < s.stamp; });
  if (next == samples_.begin() && samples_.front().stamp - from > max_gap_) return std::nullopt;
  const auto at = [&](const Sample& a, const Sample& b, double t) {
    const double share = std::clamp((t - a.stamp) / (b.stamp - a.stamp), 0.0, 1.0);
    return Sample{t, a.omega + share * (b.omega - a.omega), a.force + share * (b.force - a.force)};
  };
  const auto before = [&] { return next == samples_.begin() ? *next : *std::prev(next); };
  Sample here =
      next == samples_.begin() || next == samples_.end() ? before() : at(before(), *next, from);
  here.stamp = from;
  if (next == samples_.end() && from - samples_.back().stamp > max_gap_) return std::nullopt;
  ImuMotion motion;
  motion.dt = until - from;
  motion.has_force = true;
  for (double last = before().stamp; here.stamp < until; ++next) {
    Sample there = here;
    if (next == samples_.end()) {
      if (until - last > max_gap_) return std::nullopt;
      there.stamp = until;
    } else {
      if (next->stamp - last > max_gap_) return std::nullopt;
      there = next->stamp <= until ? *next : at(before(), *next, until);
      last = next->stamp;
    }
    const double dt = there.stamp - here.stamp;
    const Eigen::Vector3d angle = (0.5 * (here.omega + there.omega) - bias) * dt;
    const Eigen::Vector3d force = 0.5 * (here.force + there.force);
    motion.has_force = motion.has_force && force.norm() > kLeastForce;
    const Eigen::Vector3d gained = motion.R_B0B * turned(0.5 * angle) * force;
    motion.way += motion.velocity * dt + 0.5 * gained * dt * dt;
    motion.velocity += gained * dt;
    motion.R_B0B = (motion.R_B0B * turned(angle)).normalized();
    here = there;
    if (next == samples_.end()) break;
  }
  if (!motion.has_force) motion.velocity = motion.way = Eigen::Vector3d::Zero();
  return motion;
}

}  // namespace prospect
