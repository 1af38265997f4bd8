// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/live_perception.h"

#include <vector>

#include "models/depth_sensors.h"
#include "models/robot_shape.h"

namespace prospect {

PerceptionOptions live_perception(const Configuration& c, const RangeCameras& depth,
                                  const Pose& start) {
  PerceptionOptions perception = c.perception;
  perception.stereo_mount = c.robot.stereo_mount;
  const auto first = depth.find(0);
  const DepthRange range = first != depth.end()
                               ? first->second.range
                               : DepthRange{c.robot.depth.min_range, c.robot.depth.max_range};
  const CameraMount& mount = first != depth.end() ? first->second.mount : c.robot.depth_mount;
  for (const auto& [sensor, camera] : depth) {
    // The map may reach farther than one of them.
    const DepthCameraOnBody on_body{camera.camera, camera.mount, camera.range};
    if (sensor == 0) {
      perception.depth_camera = on_body;
    } else {
      perception.more_depth_cameras[sensor] = on_body;
    }
  }
  const VerticalExtent slice = c.robot.slice();
  perception.mapping.slice.z_min = slice.z_min;
  perception.mapping.slice.z_max = slice.z_max;
  perception.mapping.slice.sight = c.robot.base_height() + mount.T_BC.translation().z();
  perception.mapping.max_range = longest_range(range.max, c.robot.more_depth);
  perception.depth_mapping.range = range;
  perception.start = start;
  return perception;
}

RangeCameras range_cameras(const std::map<int, PinholeCamera>& cameras,
                           const RobotDescription& robot) {
  const std::vector<DepthSensor> sensors = robot.depth_sensors();
  RangeCameras all;
  for (const auto& [number, camera] : cameras) {
    const DepthSensor& of = sensors.at(static_cast<std::size_t>(number));
    all[number] = {camera, of.mount, {of.footprint.min_range, of.footprint.max_range}};
  }
  return all;
}

void clear_start(OccupancyMapper& map, const Configuration& c, const Pose& start) {
  map.clear_cylinder(start.position,
                     circumscribed_radius(c.robot.shape) + 0.75 * c.perception.mapping.resolution,
                     c.robot.slice().z_max - start.position.z());
  map.assume_floor(start.position.head<2>(), c.perception.start_floor);
}

}  // namespace prospect
