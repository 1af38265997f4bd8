// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "engine/maps/planar_move.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

/// A depth image of a room of 7 x 5 m with a pillar, as rays, from a robot in it: 4 m far, with
/// noise. The room turned by `turn` [rad] about the origin.
inline DepthScan room_scan(const Pose& robot, double noise, std::mt19937_64& generator,
                           double turn = 0.0, int columns = 80, int rows = 30) {
  std::normal_distribution<double> normal(0.0, 1.0);
  const PlanarMove into_room{Eigen::Vector2d::Zero(), -turn};
  const Pose inside = into_room(robot);
  DepthScan scan;
  scan.origin = robot.position;
  constexpr double kReach = 4.0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double a = inside.yaw + 1.22 * ((column + 0.5) / columns - 0.5);
      const double e = 0.9 * (0.5 - (row + 0.5) / rows);
      const Eigen::Vector3d d(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e));
      double range = std::numeric_limits<double>::infinity();
      const double low[3] = {-3.0, -2.5, 0.0}, high[3] = {4.0, 2.5, 2.2};
      for (int axis = 0; axis < 3; ++axis) {
        const double o = inside.position[axis];
        if (d[axis] > 1e-12) range = std::min(range, (high[axis] - o) / d[axis]);
        if (d[axis] < -1e-12) range = std::min(range, (low[axis] - o) / d[axis]);
      }
      // A pillar of 0.4 m at (1.5, 1).
      const Eigen::Vector2d to = Eigen::Vector2d(1.5, 1.0) - inside.position.head<2>();
      const Eigen::Vector2d flat = d.head<2>().normalized();
      const double along = to.dot(flat), beside = to.squaredNorm() - along * along;
      if (along > 0.0 && beside < 0.04) {
        range = std::min(range, (along - std::sqrt(0.04 - beside)) / d.head<2>().norm());
      }
      const Eigen::Vector3d ray = into_room.inverse()(d);
      if (range <= kReach) {
        scan.hits.emplace_back(scan.origin + ray * (range + noise * normal(generator)));
      } else {
        scan.misses.emplace_back(scan.origin + ray * 7.0);
      }
    }
  }
  return scan;
}

/// A robot's n-th place on its way about the room, round after round.
inline Pose on_the_way(int n) {
  const double a = 0.07 * n;
  Pose p;
  p.position = {0.5 + 1.6 * std::cos(a), 0.8 * std::sin(a), 0.5};
  p.yaw = 1.9 * a;
  return p;
}

}  // namespace prospect
