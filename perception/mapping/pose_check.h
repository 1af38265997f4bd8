// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "engine/maps/localization.h"
#include "models/body_transform.h"

namespace prospect {

/// Why nothing is mapped at a pose of which the odometry says so much, in words; null: it is
/// mapped.
const char* not_mapped_at(Localization pose);

/// How fast a sensor can be, and how far from the origin.
struct PoseLimits {
  double max_speed = 3.0;      ///< [m/s]
  double max_turn_rate = 6.0;  ///< [rad/s]
  double farthest = 1500.0;    ///< of any coordinate [m]
};

/// Tells poses that a moving sensor can have from others: each is held against the last one that
/// was accepted. Value type. Never throws for any time or pose.
class PoseCheck {
 public:
  explicit PoseCheck(const PoseLimits& limits = {}) : limits_(limits) {}

  /// Why a pose at `stamp` [s] cannot be, in words; null: it can. It is no rotation and
  /// translation, is too far away, or farther from the last accepted one than the limits allow in
  /// that time, with 0.05 m and 0.05 rad of slack.
  const char* problem(double stamp, const Eigen::Isometry3d& T) const;
  void accept(double stamp, const Eigen::Isometry3d& T);

  bool any() const { return any_; }  ///< whether one was accepted
  /// The last one accepted; the identity before.
  const Eigen::Isometry3d& last() const { return last_; }

 private:
  PoseLimits limits_;
  double stamp_ = 0.0;
  Eigen::Isometry3d last_ = Eigen::Isometry3d::Identity();
  bool any_ = false;
};

}  // namespace prospect
