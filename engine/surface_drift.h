#pragma once

#include <Eigen/Core>
#include <memory>

#include "engine/belief.h"
#include "engine/grid.h"
#include "engine/robot_description.h"

namespace prospect {

/// How far surfaces near the robot may be from where the map has them.
///
/// The map keeps a surface where it was last measured; the estimate of the pose drifts on. With
/// s^2(t) the variance of the estimated position along one horizontal axis, half the trace of
/// belief.covariance in (x, y), a surface last in view at t_o is, relative to the robot,
///
///     sigma = sqrt(|s^2(t) - s^2(t_o)|)        [m]
///
/// off along any axis: the drift since, for a random walk. (The variance falls where a lost robot
/// finds its pose again in its map; what was mapped while it was lost is off by what it had
/// drifted, hence the absolute value.)
///
/// In view: the occupied cells that rays over the ground from the depth sensor meet, up to and with
/// the first that is not seen through, within the sensor's range and field of view (rays half a
/// cell apart at max_range); a low obstacle only from where the sensor's lower edge meets the floor
/// on. A cell that was never in view counts as seen now.
///
/// A value, one a robot; update() once a step. Thread-safety: concurrent reads are safe.
/// Source: our choice; docs/obstacles.md and results.md say what it is worth.
class SurfaceDrift {
 public:
  /// The belief's maps are non-null, its pose finite.
  void update(const Belief& belief, const RobotDescription& robot);

  /// sigma [m] of what is in a cell, at the last update.
  double sigma(Cell c) const;

  /// The largest sigma [m] of the occupied cells whose centre is within `radius` [m] of `position`
  /// (x, y in W), at the last update; 0 if there are none.
  double sigma_near(const Eigen::Vector2d& position, double radius) const;

 private:
  std::shared_ptr<const GroundMap> ground_;
  Grid<double> variance_seen_;  // s^2 [m^2] when last in view, negative before
  double variance_ = 0.0;       // s^2 now
};

}  // namespace prospect
