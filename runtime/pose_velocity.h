// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "models/types.h"
#include "runtime/pose_jump.h"

namespace prospect {

/// How fast a body moves whose poses something else measures, in B, of who has no wheels that say
/// so: motion capture.
///
/// Lines by least squares through x, y and yaw of the poses of the newest 0.3 s, three at least:
/// with times t_i from their mean,
///   (v_x, v_y, omega)_W = sum_i t_i (x, y, yaw)_i / sum_i t_i^2,   v_B = R(-mean of yaw_i) v_W,
/// what it did half of that time ago. Poses at f Hz that err by sigma make it err by
/// sigma sqrt(12 / (f T^3)), T = 0.3 s: 1 mm at 100 Hz by 2 mm/s.
///
/// A pose that has jumped (PoseJumpWatch), or that comes more than 0.6 s after the one before,
/// begins anew; until there are three again, what was known before the jump holds. A stamp that
/// does not grow says nothing.
///
/// Thread-safety: one thread. Never throws; poses that are not finite say nothing. Source: ours.
class PoseVelocity {
 public:
  explicit PoseVelocity(const PoseJumpOptions& jump) : jumps_(jump) {}

  /// Stamps [s] are of one clock. False: it says nothing.
  bool add(double stamp, const Eigen::Isometry3d& T_WB);
  /// None: there were never three poses.
  const std::optional<Twist>& velocity() const { return velocity_; }

 private:
  struct Seen {
    double stamp = 0.0, x = 0.0, y = 0.0;
    double yaw = 0.0;  ///< without a step at pi
  };
  PoseJumpWatch jumps_;
  std::deque<Seen> seen_;
  std::optional<Twist> velocity_;
};

}  // namespace prospect
