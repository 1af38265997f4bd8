// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/wheel_encoder.h"

#include <cmath>

namespace prospect {
namespace {

/// By which the wheel has turned about the body's y axis, (-pi, pi]; forward is positive.
double turned(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::Quaterniond q = to * from.conjugate();
  return 2.0 * (q.w() < 0.0 ? std::atan2(-q.y(), -q.w()) : std::atan2(q.y(), q.w()));
}

}  // namespace

WheelEncoder::WheelEncoder(const GazeboOptions& options)
    : left_name_(options.model + "::" + options.left_wheel),
      right_name_(options.model + "::" + options.right_wheel),
      radius_(options.wheel_radius),
      separation_(options.wheel_separation) {}

std::optional<WheelSample> WheelEncoder::add(const GazeboPoses& poses) {
  const GazeboPoses::Named* const left = poses.find(left_name_);
  const GazeboPoses::Named* const right = poses.find(right_name_);
  if (left == nullptr || right == nullptr) return std::nullopt;
  const double dt = poses.stamp - stamp_;
  if (started_ && dt == 0.0) return std::nullopt;
  std::optional<WheelSample> sample;
  if (started_ && dt > 0.0) {
    const double a = radius_ * turned(left_, left->orientation);
    const double b = radius_ * turned(right_, right->orientation);
    sample = {poses.stamp, {(a + b) / (2.0 * dt), 0.0}, (b - a) / (separation_ * dt)};
  }
  started_ = true;
  stamp_ = poses.stamp;
  left_ = left->orientation;
  right_ = right->orientation;
  return sample;
}

}  // namespace prospect
