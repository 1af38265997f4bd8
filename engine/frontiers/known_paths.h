// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/frontiers/cost_to_go_field.h"
#include "engine/maps/grid.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/traversability.h"
#include "models/types.h"

namespace prospect {

/// The paths over known ground that join one place to all others, made from the map alone: for what
/// is asked seldom. Cost: linear in the map.
///
/// A value. Thread-safety: const methods may be called concurrently. Never throws on valid options
/// (Traversability) and a finite pose.
class KnownPaths {
 public:
  /// place: in W [m]; pose: of the body, whose reach counts if its heading matters.
  KnownPaths(const GroundMap& ground, const Pose& pose, const TraversabilityOptions& options,
             const Eigen::Vector2d& place, const PausePoint& pause = {});

  /// [m of path equivalent] from a cell; +infinity: there is no path.
  double length(Cell c) const { return field_.value(c); }
  /// The same from the passable cell within kNear of p from which it is least, the distance to it
  /// included [m].
  double length_near(const Eigen::Vector2d& p) const;
  /// The cells of that way from c, its end included; c alone if there is none.
  std::vector<Cell> path(Cell c) const;

 private:
  static constexpr double kNear = 0.5;  // [m]
  Traversability traversability_;
  CostToGoField field_;
};

}  // namespace prospect
