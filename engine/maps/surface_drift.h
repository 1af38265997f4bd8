// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "engine/maps/belief.h"
#include "engine/maps/grid.h"
#include "engine/maps/place_moves.h"
#include "models/robot_description.h"

namespace prospect {

/// How far what the map has near the robot, surfaces and free space, may be from where it has it.
///
/// The map keeps a thing where it was last measured; the estimate of the pose drifts on. What is
/// drawn at c from an estimate at p with the errors e_p and e_yaw is off by e(c) = e_p + J (c - p)
/// e_yaw, J a quarter turn. With P = belief.covariance in (x, y) and yaw, its variance along an
/// axis, the mean of the two, is
///
///     V_c(t) = (tr P_pp + 2 J(c - p) . P_p,yaw + |c - p|^2 P_yaw,yaw) / 2        [m^2]
///
/// and what was last in view at t_o is, relative to the robot,
///
///     sigma = sqrt(|V_c(t) - V_c(t_o)|)        [m]
///
/// off: the drift since, as what odometry adds to its errors does not depend on those it has. A yaw
/// that has been wrong all the while turns the map with the robot and does not count. (The variance
/// falls where a lost robot finds its pose again in its map; what was mapped while it was lost is
/// off by what it had drifted, hence the absolute value.)
///
/// In view: the cells of visit_ground_in_view(). A cell that was never in view counts as seen now.
/// Of a map that has shrunk or moved, cells keep when they were seen (frame_of_both()).
///
/// A covariance that is none (is_pose_covariance()) bounds nothing: what is not in view at that
/// update has sigma = infinity, also what was never in view; so the margins go as far as they can
/// and the space is unknown. Of a cell seen during such an update V_c(t_o) is not known: its sigma
/// is infinite, once it is out of view, until it is seen again with a covariance that is one.
///
/// A value, one a robot; update() once a step. Thread-safety: concurrent reads are safe.
/// Source: our choice; docs/results/obstacles.md says what it is worth.
class SurfaceDrift {
 public:
  /// The belief's maps are non-null, its pose finite.
  void update(const Belief& belief, const RobotDescription& robot);
  /// What was measured has moved in W (correction.h): a cell knows from now on what that knew which
  /// is there now; and how far that may be off is told, or stays as it was.
  void follow(const PlaceMoves& moves);

  /// sigma [m] of what is in a cell, or of there being nothing, at the last update; may be
  /// infinite.
  double sigma(Cell c) const;

  /// The largest sigma [m] of the occupied cells whose centre is within `radius` [m] of `position`
  /// (x, y in W), at the last update; 0 if there are none.
  double sigma_near(const Eigen::Vector2d& position, double radius) const;

 private:
  double variance(Cell c) const;  // V_c now [m^2]
  void cover(Cell c);
  void take_told();

  std::shared_ptr<const GroundMap> ground_;
  GridFrame map_frame_;          // what is kept is within
  Grid<double> variance_seen_;   // V_c when last in view; see surface_drift.cc
  Grid<double> told_;            // sigma^2 [m^2] at the next update; negative: not told
  Grid<std::uint32_t> in_view_;  // the update at which a cell was last in view
  std::uint32_t updates_ = 0;
  bool bounded_ = true;                                   // the covariance is one
  Eigen::Vector2d position_ = Eigen::Vector2d::Zero();    // p
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();  // P of (x, y, yaw)
};

}  // namespace prospect
