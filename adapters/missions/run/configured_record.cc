// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/configured_record.h"

#include "models/robot_shape.h"

namespace prospect {

RunRecord configured_record(const Configuration& configuration) {
  RunRecord record;
  record.resolution = configuration.perception.mapping.resolution;
  record.robot_radius = circumscribed_radius(configuration.robot.shape);
  record.sensor_range = configuration.robot.depth.max_range;
  record.sensor_fov = configuration.robot.depth.horizontal_fov;
  record.configuration = effective_yaml(configuration.entries);
  record.zones = configuration.planner.zones;
  record.area = configuration.planner.task.area;
  return record;
}

}  // namespace prospect
