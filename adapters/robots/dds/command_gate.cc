// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/command_gate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "models/range_text.h"

namespace prospect {
namespace {

Eigen::Vector3d vector_of(const ros::Vector3& v) { return {v.x, v.y, v.z}; }

ros::Twist twist_of(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  ros::Twist twist;
  twist.linear = {linear.x(), linear.y(), linear.z()};
  twist.angular = {angular.x(), angular.y(), angular.z()};
  return twist;
}

std::string short_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

double share_within(const Eigen::Vector3d& value, double most) {
  constexpr double kRounding = 1e-9;
  const double size = value.norm();
  return size > (1.0 + kRounding) * most ? most / size : 1.0;
}

/// From `from` towards `to`: first by braking, which is free, then by `most` at most.
Eigen::Vector3d led(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double most) {
  const double squared = from.squaredNorm();
  const double kept = squared > 0.0 ? std::clamp(to.dot(from) / squared, 0.0, 1.0) : 0.0;
  const Eigen::Vector3d braked = kept * from;
  const Eigen::Vector3d step = to - braked;
  const double share = share_within(step, most);
  return share < 1.0 ? Eigen::Vector3d(braked + share * step) : to;
}

}  // namespace

void CommandGate::take(const ros::Twist& command, double age, double now) {
  Eigen::Vector3d linear = vector_of(command.linear), angular = vector_of(command.angular);
  if (!linear.allFinite() || !angular.allFinite()) {
    complain(Wrong::kNotFinite, "a command is not finite; expected numbers", now);
    linear.setZero();
    angular.setZero();
    age = 0.0;  // a stop is never too old
  } else if (linear.isZero(0.0) && angular.isZero(0.0)) {
    age = 0.0;
  }
  if (!(std::abs(age) < limits_.dead_man)) {
    const bool old = !(age < 0.0);
    complain(old ? Wrong::kTooOld : Wrong::kAhead,
             "a command is stamped " + short_text(std::abs(age)) + " s " + (old ? "ago" : "ahead") +
                 " by this computer's clock; expected less than " + exact_text(limits_.dead_man) +
                 " s",
             now);
    return;
  }
  const double share =
      std::min(share_within(linear, limits_.speed), share_within(angular, limits_.yaw_rate));
  if (share < 1.0) {
    complain(Wrong::kTooFast,
             "a command is " + short_text(linear.norm()) + " m/s, " + short_text(angular.norm()) +
                 " rad/s; expected at most " + exact_text(limits_.speed) + " m/s, " +
                 exact_text(limits_.yaw_rate) + " rad/s",
             now);
  }
  wanted_linear_ = share * linear;
  wanted_angular_ = share * angular;
  since_ = now - std::max(0.0, age);
  fresh_ = true;
}

std::optional<ros::Twist> CommandGate::output(const std::vector<std::string>& commanders,
                                              double now) {
  constexpr double kEven = 0.2;  // [s]
  if (!since_) return std::nullopt;
  const bool several = commanders.size() > 1;
  if (several) {
    std::string names;
    for (const std::string& name : commanders) names += (names.empty() ? "" : ", ") + name;
    complain(
        Wrong::kCommanders,
        std::to_string(commanders.size()) + " publishers of commands: " + names + "; expected one",
        now);
    since_ = now - limits_.dead_man;  // what they have said does not count later, either
  }
  if (closed_ || several || now - *since_ >= limits_.dead_man) {
    linear_.setZero();
    angular_.setZero();
  } else {
    if (!fresh_ && linear_ == wanted_linear_ && angular_ == wanted_angular_) return std::nullopt;
    const double dt = sent_ ? std::clamp(now - *sent_, 0.0, limits_.dead_man) : limits_.period;
    linear_ = led(linear_, wanted_linear_, limits_.acceleration * dt);
    angular_ = led(angular_, wanted_angular_, limits_.yaw_acceleration * dt);
    if ((wanted_linear_ - linear_).norm() > kEven * limits_.acceleration ||
        (wanted_angular_ - angular_).norm() > kEven * limits_.yaw_acceleration) {
      complain(Wrong::kTooSudden,
               "a command changes by more than " + exact_text(limits_.acceleration) + " m/s^2, " +
                   exact_text(limits_.yaw_acceleration) + " rad/s^2; it is led there by that",
               now);
    }
  }
  sent_ = now;
  fresh_ = false;
  return twist_of(linear_, angular_);
}

std::string CommandGate::complaint(double now) const {
  constexpr double kTold = 1.0;  // [s]
  return wrong_ != Wrong::kNothing && now - complained_ < kTold ? line_ : "";
}

void CommandGate::complain(Wrong wrong, const std::string& line, double now) {
  // One line for a row of the same: its numbers may differ each time.
  if (wrong != wrong_ || complaint(now).empty()) line_ = line;
  wrong_ = wrong;
  complained_ = now;
}

}  // namespace prospect
