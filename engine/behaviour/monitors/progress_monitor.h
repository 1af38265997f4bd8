// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace prospect {

class Knobs;

/// Whether a robot gets on towards its target, in one visit to it: from where it was chosen until
/// it is left.
///
/// Progress is `area` newly explored, or a place p from which the target is nearer by `distance`
/// than from the nearest place q where the robot has been in this visit,
///
///     V(p) <= V(q) - distance,
///
/// V the cost-to-go as it is now, at both. So what a retreat gave away and the robot regains is no
/// progress, nor is a cost-to-go that changes under a robot that stands; and on a path that has
/// become longer (a door turned out closed) progress is against what that costs. A visit whose
/// localization is lost again without progress in between has failed.
///
/// A value: one a robot. Thread-safety: none. Never throws after construction, but what V throws.
/// Source: our choice.
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

  /// V [m] at a place in W [m]; +infinity where it says nothing.
  using CostToGoAt = std::function<double(const Eigen::Vector2d&)>;

  /// Once each step, before the others: `stamp` [s], explored [m^2].
  void begin(double stamp, double explored);
  /// The time since begin(), up to `stamp` [s], does not count: the robot had something else to do.
  void hold(double stamp);
  /// No target can be reached, at begin()'s stamp.
  void no_target();
  /// The target was given up for another reason.
  void target_dropped() { stalled_ = false; }
  /// The target, same: of the same visit; position in W [m], where V is finite.
  void update(bool same, const Eigen::Vector2d& position, const CostToGoAt& cost_to_go,
              double explored);
  /// Localization got lost. Returns whether it was so before in this visit, without progress since.
  bool lost_again();
  /// What was measured has moved in W: where a place is now.
  void follow(const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& now);
  /// The target is given up as hopeless: the clock begins anew.
  void given_up(double explored);

  /// [s] since the last progress.
  double stalled_for() const { return stalled_for_; }
  /// No progress was made for stalled_after; since then nothing new was seen of the same target,
  /// and the robot did not get away.
  bool stalled() const { return stalled_; }
  bool hopeless() const;

 private:
  void got_on();

  Options options_;
  std::optional<double> progress_at_;       // [s]
  double stamp_ = 0.0;                      // [s] of the last begin()
  std::optional<Eigen::Vector2d> nearest_;  // q
  double explored_ = 0.0;                   // [m^2] at the last progress by area
  double stalled_for_ = 0.0;                // [s]
  bool lost_ = false;                       // in this visit, since the last progress
  bool stalled_ = false;
  Eigen::Vector2d stalled_at_ = Eigen::Vector2d::Zero();  // where it began to be
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, ProgressMonitor::Options& options);

}  // namespace prospect
