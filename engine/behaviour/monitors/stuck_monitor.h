// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

namespace prospect {

/// Notices a robot that tries to get on and does not: it stands or turns on the spot in a place so
/// narrow that no path out keeps the distances asked for.
///
/// The robot is stuck once it has tried for kPatience to get farther than kLeash from one
/// place, and remains so until it is kAway from there. Time in which it did not try (lost,
/// retreating, turning) does not count.
///
/// A value: one a robot. Thread-safety: none. Never throws. Source: our choice.
class StuckMonitor {
 public:
  static constexpr double kPatience = 10.0;  ///< [s]: more than a turn to look all around takes
  static constexpr double kLeash = 0.2;      ///< [m]
  static constexpr double kAway = 0.5;       ///< [m]

  /// position in W (x, y) [m] at `stamp` [s]; tried: since the last update the robot tried to get
  /// on. Returns stuck(). Values that are not finite change nothing.
  bool update(double stamp, const Eigen::Vector2d& position, bool tried);

  /// Whether the robot is stuck.
  bool stuck() const { return stuck_; }

 private:
  bool stuck_ = false;
  std::optional<Eigen::Vector2d> anchor_;  // none before the first update
  double tried_for_ = 0.0;                 // [s] at the anchor
  double last_ = 0.0;                      // [s]
};

}  // namespace prospect
