// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

namespace prospect {

class Knobs;

/// Whether a robot gets on towards its target.
///
/// Progress is `area` newly explored, or a fall of the cost-to-go at the robot by `distance` under
/// its least value for this target while the robot has moved as far: a cell that noise opens and
/// closes moves the cost-to-go of a robot that stands. A way that has become longer by 2 `distance`
/// (a door turned out closed) is measured anew, on the same clock.
///
/// A value: one a robot. Thread-safety: none. Never throws after construction. Source: our choice.
class ProgressMonitor {
 public:
  struct Options {
    double stalled_after = 3.0;   ///< [s] without progress
    double hopeless_after = 8.0;  ///< [s] without progress, more than stalled_after
    double distance = 0.2;        ///< [m]
    double area = 0.1;            ///< [m^2]
    double away = 1.0;            ///< [m] from where it stalled, a robot that gets on has got away
  };

  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit ProgressMonitor(const Options& options);

  /// Once each step, before the others: `stamp` [s], position in W [m], explored [m^2].
  void begin(double stamp, const Eigen::Vector2d& position, double explored, double cost_to_go);
  /// The time since begin(), up to `stamp` [s], does not count: the robot had something else to do.
  void hold(double stamp);
  /// No target can be reached, at begin()'s stamp.
  void no_target();
  /// The target was given up for another reason.
  void target_dropped() { stalled_ = false; }
  /// The target, same: as before; position in W [m]; cost_to_go [m] there.
  void update(bool same, const Eigen::Vector2d& position, double cost_to_go, double explored);
  /// The target is given up as hopeless: the clock begins anew.
  void given_up(double explored);

  /// [s] since the last progress.
  double stalled_for() const { return stalled_for_; }
  /// No progress was made for stalled_after; since then nothing new was seen of the same target,
  /// and the robot did not get away.
  bool stalled() const { return stalled_; }
  bool hopeless() const;

 private:
  Options options_;
  std::optional<double> progress_at_;                   // [s]
  double stamp_ = 0.0;                                  // [s] of the last begin()
  Eigen::Vector2d position_ = Eigen::Vector2d::Zero();  // at the last progress by distance
  double least_ = 0.0;                                  // [m] cost-to-go
  double explored_ = 0.0;                               // [m^2] at the last progress by area
  double stalled_for_ = 0.0;                            // [s]
  bool stalled_ = false;
  Eigen::Vector2d stalled_at_ = Eigen::Vector2d::Zero();  // where it began to be
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, ProgressMonitor::Options& options);

}  // namespace prospect
