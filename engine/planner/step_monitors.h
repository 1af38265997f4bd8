// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "engine/behaviour/facts.h"
#include "engine/behaviour/monitors/following_monitor.h"
#include "engine/behaviour/monitors/localization_monitor.h"
#include "engine/behaviour/monitors/stuck_monitor.h"
#include "engine/maps/belief.h"
#include "engine/maps/place_moves.h"
#include "engine/planner/retreat.h"
#include "engine/planner/task_clock.h"

namespace prospect {

/// Points tracked, in N_min, with which a robot goes on exploring after a retreat.
inline constexpr double kEnoughToGoOn = 1.5;

/// Whether the belief's localization rests on visible features.
bool rests_on_features(const Belief& belief);

/// The facts of a step that do not depend on where the robot is to go, and the monitors behind
/// them.
///
/// A value: one a planner. Thread-safety: none. Never throws on a belief whose pose is finite.
class StepMonitors {
 public:
  /// At each step, once: what the belief says and what follows from those before it, but for
  /// Facts::stuck, goal and frontiers. clock: of this step. N_min: features below which odometry is
  /// not to be trusted.
  Facts update(const Belief& belief, TaskKind task, const TaskClock& clock, double N_min);

  /// Facts::stuck; pursues: the robot tries to reach its target in this step.
  bool update_stuck(const Belief& belief, bool pursues);

  /// What was measured has moved in W (correction.h).
  void follow(const PlaceMoves& moves);

  /// The direction in W in which the robot does not get on, noticed in this step: it turns away.
  const std::optional<Eigen::Vector2d>& blocked() const { return blocked_; }
  /// Localization got lost in this step.
  bool got_lost() const { return localization_.got_lost(); }
  /// Where enough features were tracked.
  const RetreatTrail& trail() const { return trail_; }

 private:
  LocalizationMonitor localization_;
  FollowingMonitor following_;
  StuckMonitor stuck_;
  RetreatTrail trail_;
  std::optional<Eigen::Vector2d> blocked_;
  std::optional<Eigen::Vector2d> began_at_;  // in W [m]
  double strayed_ = 0.0;                     // [m] farthest from there
};

}  // namespace prospect
