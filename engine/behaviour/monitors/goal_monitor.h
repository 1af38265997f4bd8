// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <optional>

#include "engine/behaviour/monitors/nearest_place.h"

namespace prospect {

/// Whether a robot gets on towards a goal.
///
/// Progress is as ProgressMonitor's: `area` newly explored, or a place p whose cost-to-go V is less
/// by `distance` than that of the nearest place q where the robot has been on this way,
///
///     V(p) <= V(q) - distance,
///
/// V as it is now, at both. So who circles near the goal, or gives way and regains it, makes none,
/// and on a way that has become longer (a door turned out closed) progress is against what that
/// costs. Time in which the robot had something else to do does not count.
///
/// A value: one a goal. Thread-safety: none. Never throws, but what V throws. Source: our choice.
class GoalMonitor {
 public:
  static constexpr double kDistance = 0.2;       ///< [m]
  static constexpr double kArea = 0.1;           ///< [m^2]
  static constexpr double kStalledAfter = 3.0;   ///< [s]
  static constexpr double kHopelessAfter = 8.0;  ///< [s]

  /// V [m] at a place in W [m]; +infinity where it says nothing.
  using CostToGoAt = std::function<double(const Eigen::Vector2d&)>;

  /// At `stamp` [s], position in W [m], where V is finite, explored [m^2]; pursued: since the last
  /// update the robot tried to get there.
  void update(double stamp, const Eigen::Vector2d& position, const CostToGoAt& cost_to_go,
              double explored, bool pursued) {
    if (!last_) {
      explored_ = explored;
      stalled_for_ = 0.0;
    } else if (pursued) {
      stalled_for_ += std::max(0.0, stamp - *last_);
    }
    last_ = stamp;
    if (got_nearer(nearest_, position, cost_to_go, kDistance)) stalled_for_ = 0.0;
    if (explored - explored_ >= kArea) {
      explored_ = explored;
      stalled_for_ = 0.0;
    }
  }
  /// The way is another one: its time begins now.
  void restart() { *this = {}; }
  /// What was measured has moved in W: where a place is now.
  void follow(const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& now) {
    if (nearest_) nearest_ = now(*nearest_);
  }

  double stalled_for() const { return stalled_for_; }  ///< [s] since the last progress
  bool stalled() const { return stalled_for_ >= kStalledAfter - 1e-9; }
  bool hopeless() const { return stalled_for_ >= kHopelessAfter - 1e-9; }

 private:
  std::optional<double> last_;              // [s]
  std::optional<Eigen::Vector2d> nearest_;  // q
  double explored_ = 0.0;                   // [m^2] at the last progress by area
  double stalled_for_ = 0.0;                // [s]
};

}  // namespace prospect
