// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/frontiers/cost_to_go.h"
#include "engine/maps/place_moves.h"
#include "engine/maps/traversability.h"
#include "models/types.h"

namespace prospect {

/// Where the robot has been while enough features were tracked: the places worth going back to.
///
/// A value, owned by the planner. Deterministic. Thread-safety: none. Source: our choice (the
/// formulation asks to "turn and retreat to where features are").
class RetreatTrail {
 public:
  static constexpr double kAway = 0.5, kReach = 6.0;  ///< [m]

  /// Notes a place and how many features were tracked there, at most one each `spacing` [m].
  void note(const Eigen::Vector2d& position, int tracked, double spacing = 0.3);
  /// What was measured has moved in W (correction.h).
  void follow(const PlaceMoves& moves);
  const std::vector<Eigen::Vector2d>& places() const { return places_; }
  /// Features tracked at the newest place; 0 without one.
  int tracked_at_newest() const { return tracked_; }

  /// Cost-to-go [s] to the nearest noted place at least `away` metres from the robot (the nearest
  /// one of all if there is none), over the cells within `reach` of the robot: Dijkstra over 8
  /// neighbours, passable cells at their factor, all others at 3 per metre, so it is finite
  /// everywhere. Null if nothing was noted within reach.
  std::shared_ptr<const CostToGo> cost_to_go(const Traversability& traversability,
                                             const Eigen::Vector2d& robot, double v_max,
                                             double away = kAway, double reach = kReach) const;
  /// The same over the cells of `factors`, that of which, 0 where impassable, it holds.
  std::shared_ptr<const CostToGo> cost_to_go(const Grid<float>& factors,
                                             const Eigen::Vector2d& robot, double v_max,
                                             double away = kAway,
                                             const PausePoint& pause = {}) const;
  /// Those within `reach` of the robot, at a finite position.
  static Grid<float> factors_around(const Eigen::Vector2d& robot,
                                    const Traversability& traversability, double reach = kReach);

 private:
  std::vector<Eigen::Vector2d> places_;
  int tracked_ = 0;  // at the newest
};

}  // namespace prospect
