// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "models/types.h"

namespace prospect {

/// Notices that a robot does not follow its commands over ground: it touches something that its map
/// has elsewhere, or a wheel spins.
///
/// From the place where the robot last stood (the anchor), the commands are integrated to the
/// displacement that they ask for,
///
///     d <- d + R(yaw) (v_before + v) / 2 * (t - t_before)      (in W, horizontal, [m])
///
/// and the motion is blocked once |d| >= kAsked while the robot is still within kMoved of the
/// anchor. Once it is not, the anchor moves there and d begins anew. To and fro or on a small
/// circle d stays small, as the displacement does.
///
/// A value: one a robot. Thread-safety: none. Never throws. Source: our choice.
class FollowingMonitor {
 public:
  static constexpr double kAsked = 0.3;    ///< [m]
  static constexpr double kMoved = 0.1;    ///< [m]
  static constexpr double kLongest = 2.0;  ///< [s] between two steps that belong together

  /// pose, in W, at `stamp` [s]; command: body velocity in force. Returns the unit direction (in W)
  /// in which the motion is blocked, if it is, and begins anew then. Values that are not finite and
  /// stamps that do not grow, or by more than kLongest, begin anew, too.
  std::optional<Eigen::Vector2d> update(double stamp, const Pose& pose, const Twist& command);

  /// Forgets the past: where it is unknown how the robot moved.
  void reset() { last_.reset(); }

  /// [s] when it was last noticed; none: never.
  std::optional<double> noticed_at() const { return noticed_at_; }

 private:
  struct Step {
    double stamp;
    Eigen::Vector2d velocity;  // in W
  };
  std::optional<Step> last_;
  Eigen::Vector2d anchor_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d asked_ = Eigen::Vector2d::Zero();  // d
  std::optional<double> noticed_at_;
};

}  // namespace prospect
