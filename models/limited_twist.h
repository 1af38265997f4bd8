// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "models/motion_model.h"

namespace prospect {

inline bool is_finite(const Twist& twist) {
  return twist.linear.allFinite() && std::isfinite(twist.yaw_rate);
}

/// At most 1 mm/s and 1 mrad/s: slower is no motion.
inline bool is_at_rest(const Twist& twist) {
  constexpr double kRest = 1e-3;  // [m/s] and [rad/s]
  return twist.linear.norm() <= kRest && std::abs(twist.yaw_rate) <= kRest;
}

/// The body velocity nearest in direction that the model allows: linear scaled down to max_speed(),
/// yaw rate clamped to max_yaw_rate(); zero if it is not finite.
inline Twist limited_twist(const MotionModel& model, const Twist& twist) {
  if (!is_finite(twist)) return {};
  Twist limited = twist;
  // Scaled twice, so that the square of a huge entry does not overflow.
  const double largest = limited.linear.cwiseAbs().maxCoeff();
  if (largest > model.max_speed()) limited.linear *= model.max_speed() / largest;
  const double speed = limited.linear.norm();
  if (speed > model.max_speed()) limited.linear *= model.max_speed() / speed;
  limited.yaw_rate = std::clamp(twist.yaw_rate, -model.max_yaw_rate(), model.max_yaw_rate());
  return limited;
}

}  // namespace prospect
