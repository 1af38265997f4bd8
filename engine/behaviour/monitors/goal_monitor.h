// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

namespace prospect {

/// Whether a robot gets on towards a goal.
///
/// Progress is `distance` nearer to it, down the path, than ever before while the robot has moved
/// as far, or `area` newly explored. A way that has become longer by 2 `distance` (a door turned
/// out closed) is measured anew, on the same clock. Time in which the robot had something else to
/// do does not count.
///
/// A value: one a goal. Thread-safety: none. Never throws. Source: our choice.
class GoalMonitor {
 public:
  static constexpr double kDistance = 0.2;       ///< [m]
  static constexpr double kArea = 0.1;           ///< [m^2]
  static constexpr double kStalledAfter = 3.0;   ///< [s]
  static constexpr double kHopelessAfter = 8.0;  ///< [s]

  /// At `stamp` [s], position in W [m], way left [m], explored [m^2]; pursued: since the last
  /// update the robot tried to get there.
  void update(double stamp, const Eigen::Vector2d& position, double path, double explored,
              bool pursued) {
    if (!last_) {
      begin(position, path, explored);
    } else if (pursued) {
      stalled_for_ += std::max(0.0, stamp - *last_);
    }
    last_ = stamp;
    if (path > least_ + 2.0 * kDistance) least_ = path;
    const bool nearer = path <= least_ - kDistance && (position - position_).norm() >= kDistance;
    if (nearer || explored - explored_ >= kArea) begin(position, path, explored);
  }
  /// The path is another one: its time begins now.
  void restart() { last_.reset(); }

  double stalled_for() const { return stalled_for_; }  ///< [s] since the last progress
  bool stalled() const { return stalled_for_ >= kStalledAfter - 1e-9; }
  bool hopeless() const { return stalled_for_ >= kHopelessAfter - 1e-9; }

 private:
  void begin(const Eigen::Vector2d& position, double path, double explored) {
    position_ = position;
    least_ = path;
    explored_ = explored;
    stalled_for_ = 0.0;
  }

  std::optional<double> last_;                          // [s]
  Eigen::Vector2d position_ = Eigen::Vector2d::Zero();  // at the last progress
  double least_ = 0.0;                                  // [m]
  double explored_ = 0.0;                               // [m^2] at the last progress
  double stalled_for_ = 0.0;                            // [s]
};

}  // namespace prospect
