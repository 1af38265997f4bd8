#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/cost_to_go.h"

namespace prospect {

/// The way down the cost-to-go from a point, for steering by pure pursuit: towards the point
/// `lookahead` ahead rather than along the local gradient, which turns from cell to cell in a
/// narrow passage.
///
/// A value. Thread-safety: const methods may be called concurrently. Source: pure pursuit (Coulter,
/// CMU-RI-TR-92-01) on CostToGo::descend.
class DescentPath {
 public:
  /// from in W [m]; length [m].
  DescentPath(const CostToGo& cost_to_go, const Eigen::Vector2d& from, double length);

  /// [m] as the crow flies from p to the end of the path.
  double left(const Eigen::Vector2d& p) const { return (points_.back() - p).norm(); }

  /// Heading [rad] from p to the point `lookahead` [m] further on from the one nearest to p;
  /// `otherwise` within 0.15 m of it, which happens at the path's end, where any heading will do.
  double heading(const Eigen::Vector2d& p, double lookahead, double otherwise) const;

 private:
  std::vector<Eigen::Vector2d> points_;  // not empty
};

}  // namespace prospect
