// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "models/robot_description.h"

namespace prospect {

/// The stretch straight ahead along B's x axis on which a level floor is in view [m from B's
/// origin]. What is nearer lies in the blind zone before the wheels: it has to have been seen.
struct FloorSight {
  double from = 0.0;
  double to = 0.0;
};

/// The widest such stretch of one of the sensors: a ray that is e below the horizontal, straight
/// ahead, meets the floor at x = t_x + h / tan e, h the sensor's height above the floor, if that is
/// in the sensor's field of view and range. None: no sensor looks there. Pure.
std::optional<FloorSight> floor_sight(const std::vector<DepthSensor>& sensors, double base_height);

/// The fastest [m/s] that a robot may be at if what comes into view at `sight` [m ahead of its
/// front] is to keep it: the largest v with  v delay + v^2 / (2 deceleration) <= sight.
double speed_for_sight(double sight, double delay, double deceleration);

}  // namespace prospect
