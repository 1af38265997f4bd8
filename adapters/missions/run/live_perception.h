// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "adapters/missions/config/configuration.h"
#include "models/types.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/pipeline/perception_options.h"
#include "runtime/range_check.h"

namespace prospect {

/// How a robot with its own cameras perceives: configuration.perception, with what the robot has.
/// depth: its depth cameras, by the number of the depth sensor; what has none sends scans.
PerceptionOptions live_perception(const Configuration& configuration, const RangeCameras& depth,
                                  const Pose& start);

/// Cameras of the robot's depth sensors, by the number of the sensor, each where it sits.
RangeCameras range_cameras(const std::map<int, PinholeCamera>& cameras,
                           const RobotDescription& robot);

/// Makes the place free that the body takes up where it was put down.
void clear_start(OccupancyMapper& map, const Configuration& configuration, const Pose& start);

}  // namespace prospect
