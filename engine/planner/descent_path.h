// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/frontiers/cost_to_go.h"
#include "engine/maps/clearance_field.h"

namespace prospect {

/// The path down the cost-to-go from a point, for steering by pure pursuit: towards the point
/// `lookahead` ahead rather than along the local gradient, which turns from cell to cell in a
/// narrow passage.
///
/// A value. Thread-safety: const methods may be called concurrently. Source: pure pursuit (Coulter,
/// CMU-RI-TR-92-01) on CostToGo::descend.
class DescentPath {
 public:
  /// from in W [m]; length [m].
  DescentPath(const CostToGo& cost_to_go, const Eigen::Vector2d& from, double length);

  /// Moves every point but the first sideways, up the gradient of the clearance d, until d(point) =
  /// `enough`, d rises no more, or `most` [m] were gone: the cost-to-go's cells are a voxel wide,
  /// and in a gap not much wider than the robot their centres are not its middle. z [m, in W] is
  /// where d is asked (any, of a planar field).
  void centre(const ClearanceField& clearance, double z, double enough, double most);

  /// [m] as the crow flies from p to the end of the path.
  double left(const Eigen::Vector2d& p) const { return (points_.back() - p).norm(); }

  /// Heading [rad] from p to the point `lookahead` [m] further on from the one nearest to p;
  /// `otherwise` within 0.15 m or half the lookahead of it, which happens at the path's end, where
  /// any heading will do.
  double heading(const Eigen::Vector2d& p, double lookahead, double otherwise) const;

 private:
  std::vector<Eigen::Vector2d> points_;  // not empty
};

}  // namespace prospect
