// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "models/body_transform.h"
#include "perception/mapping/occupancy_mapper.h"

// Stands for a lidar and its surroundings: a room of 9 x 4 m with a box in the way.

constexpr double kLidarRange = 3.0;  // [m]

inline bool occupied(double x, double y) {
  const bool wall = x < -0.95 || x > 7.95 || y < -1.95 || y > 1.95;
  return wall || (x > 1.5 && x < 2.0 && y > -0.3 && y < 0.5);
}

// One turn, 0.25 m above the floor, in the frame of the body that is at `pose`.
inline prospect::DepthScan turn_of_lidar(const prospect::Pose& pose) {
  prospect::DepthScan scan;
  scan.origin = {0.0, 0.0, 0.25};
  for (double angle = 0.0; angle < 2.0 * M_PI; angle += 0.01) {
    const Eigen::Vector3d ray(std::cos(angle), std::sin(angle), 0.0);
    const Eigen::Vector3d ray_W = prospect::body_transform(pose).rotation() * ray;
    const auto free = [&](double d) {
      const Eigen::Vector3d end = pose.position + d * ray_W;
      return !occupied(end.x(), end.y());
    };
    double d = 0.0;
    while (d < kLidarRange && free(d)) d += 0.02;
    (d < kLidarRange ? scan.hits : scan.misses).push_back(scan.origin + d * ray);
  }
  return scan;
}
