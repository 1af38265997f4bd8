// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/frontiers/goal_sources.h"
#include "engine/maps/grid.h"
#include "engine/maps/traversability.h"
#include "engine/task/polygon.h"

namespace prospect {

/// Where the cost-to-go to what is unknown of an area begins: at each cell of it that the robot
/// could pass, at 0, in parts (4-connected) of at least kLeastPart; and at cells beside the map's
/// rim, at `beyond` times the distance to what of the area lies outside the map, as GoalSources.
///
/// What lies in a forbidden part or outside of TraversabilityOptions::extent does not count.
///
/// A value. Thread-safety: const methods may be called concurrently. Source: our choice.
class AreaSources {
 public:
  static constexpr double kLeastPart = 0.5;  ///< [m^2]

  /// area: usable (polygon_fault()). traversability: unknown_travel > 0.
  AreaSources(const Traversability& traversability, const Polygon& area,
              const PausePoint& pause = {});

  /// [m of path equivalent]; infinity: none.
  float source(Cell c) const;
  /// None: other sources are another value, for which the field is solved anew.
  const std::vector<Cell>& changed_sources() const { return none_; }
  /// Distance from p to what of the area lies outside the map [m]; infinity: nothing does.
  double outside(const Eigen::Vector2d& p) const;
  /// Free cells of the area, times the area of a cell [m^2].
  double seen() const { return seen_; }
  /// Nothing of the area is within extent and outside of forbidden parts, as far as the map
  /// reaches.
  bool nowhere() const { return counted_ == 0 && outside_.empty(); }
  /// Nothing of it lies within extent.
  bool beyond_extent() const { return beyond_extent_; }

 private:
  GridFrame frame_;
  double beyond_ = 1.0;
  Grid<std::uint8_t> wanted_;     // 1: a source
  std::vector<Polygon> outside_;  // what of the area lies beyond each side of the map
  double seen_ = 0.0;
  int counted_ = 0;
  bool beyond_extent_ = false;
  std::vector<Cell> none_;
};

}  // namespace prospect
