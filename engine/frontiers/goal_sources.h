// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <vector>

#include "engine/maps/grid.h"

namespace prospect {

/// Where the cost-to-go to a place begins.
///
///   the place lies within the frame's rim:  every cell whose centre is within `radius` of it costs
///       the distance between the two [m], so that a lattice that has no passable cell at the very
///       place has one beside it;
///   else:  every cell beside the rim costs `beyond` times its distance to the place: what lies
///       outside the map is unknown, and the straight way is the shortest.
///
/// A value. Thread-safety: const methods may be called concurrently.
class GoalSources {
 public:
  GoalSources(const GridFrame& frame, const Eigen::Vector2d& goal, double radius, double beyond)
      : frame_(frame), goal_(goal), radius_(radius), beyond_(beyond) {
    const Cell c = frame.cell(goal.x(), goal.y());
    within_ = depth(c) >= 1;
  }

  /// [m of path equivalent]; infinity: none.
  float source(Cell c) const {
    const double distance = (frame_.center(c) - goal_).norm();
    if (within_ ? distance <= radius_ : depth(c) == 1) {
      return static_cast<float>(within_ ? distance : beyond_ * distance);
    }
    return std::numeric_limits<float>::infinity();
  }
  /// None: other sources are another value, for which the field is solved anew.
  const std::vector<Cell>& changed_sources() const { return none_; }
  /// Whether the place lies within the frame.
  bool within() const { return within_; }

 private:
  /// Cells between c and the outermost ones; 0: one of those, or outside.
  int depth(Cell c) const {
    return std::max(0,
                    std::min({c.i - frame_.i0, c.j - frame_.j0, frame_.i0 + frame_.width - 1 - c.i,
                              frame_.j0 + frame_.height - 1 - c.j}));
  }

  GridFrame frame_;
  Eigen::Vector2d goal_;
  double radius_, beyond_;
  bool within_ = false;
  std::vector<Cell> none_;
};

}  // namespace prospect
