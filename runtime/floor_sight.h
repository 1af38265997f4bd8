// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "models/robot_description.h"

namespace prospect {

/// The stretch straight ahead along B's x axis on which a sensor shows whether there is floor [m
/// from B's origin]. What is nearer lies in the blind zone before the wheels: it has to have been
/// seen.
struct FloorSight {
  double from = 0.0;
  double to = 0.0;
};

/// The widest such stretch of one of the sensors. A ray that is e below the horizontal, straight
/// ahead, meets a level floor at x = t_x + h / tan e, h the sensor's height above the floor. It
/// shows that there is floor if its range holds h / sin e, and that there is none if it holds
/// (h + drop) / sin e, too: it has to get down by `drop` [m], as deep as a floor may lie that still
/// is one. None: no sensor looks there. Pure.
std::optional<FloorSight> floor_sight(const std::vector<DepthSensor>& sensors, double base_height,
                                      double drop);

/// The fastest [m/s] that a robot may be at if what comes into view at `sight` [m ahead of its
/// front] is to keep it: the largest v with  v delay + v^2 / (2 deceleration) <= sight.
double speed_for_sight(double sight, double delay, double deceleration);

}  // namespace prospect
