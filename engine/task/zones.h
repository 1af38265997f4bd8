// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/task/polygon.h"

namespace prospect {

/// Where the robot may drive no faster than so.
struct SpeedZone {
  Polygon area;
  double max_speed = 0.3;  ///< [m/s], > 0
};

/// What a robot is told of the ground besides its map: prisms of unbounded height over polygons in
/// the map's frame. (A robot that has drifted keeps off where it believes they are.)
struct Zones {
  std::optional<Polygon> bound;   ///< the body stays within; none: anywhere
  std::vector<Polygon> keep_out;  ///< the body stays out of each
  std::vector<SpeedZone> slow;    ///< where B's origin is in one, the linear speed keeps to it

  bool empty() const { return !bound && keep_out.empty() && slow.empty(); }
};

/// One line a fault, "keep_out[1]: sides 1 and 3 meet; expected ..."; empty: usable.
std::vector<std::string> faults(const Zones& zones);

}  // namespace prospect
