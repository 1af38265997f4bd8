// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/robot_description.h"

namespace prospect {

/// Throws std::invalid_argument, which begins with the owner's name, if there are more depth
/// sensors than kMostDepthSensors; as validate() for one that is none.
inline void validate(const std::string& owner, const std::vector<DepthSensor>& sensors) {
  if (sensors.size() > static_cast<std::size_t>(kMostDepthSensors)) {
    throw std::invalid_argument(owner + ": " + std::to_string(sensors.size()) +
                                " depth sensors; expected at most " +
                                std::to_string(kMostDepthSensors));
  }
  for (const DepthSensor& sensor : sensors) {
    validate(sensor.footprint);
    validate(sensor.mount);
  }
}

/// How far the farthest of several depth sensors measures [m]: the first, to `first`, and more.
inline double longest_range(double first, const std::vector<DepthSensor>& more) {
  for (const DepthSensor& sensor : more) first = std::max(first, sensor.footprint.max_range);
  return first;
}

}  // namespace prospect
