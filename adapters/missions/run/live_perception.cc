#include "adapters/missions/run/live_perception.h"

#include <algorithm>

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
    if (sensor == 0) {
      perception.depth_camera = {camera.camera, mount};
    } else {
      perception.more_depth_cameras[sensor] = {camera.camera, camera.mount, camera.range};
    }
  }
  const VerticalExtent slice = c.robot.slice();
  perception.mapping.slice.z_min = slice.z_min;
  perception.mapping.slice.z_max = slice.z_max;
  perception.mapping.slice.sight = c.robot.base_height() + mount.T_BC.translation().z();
  perception.mapping.max_range = range.max;
  for (const DepthSensor& sensor : c.robot.more_depth) {
    perception.mapping.max_range =
        std::max(perception.mapping.max_range, sensor.footprint.max_range);
  }
  // The map reaches farther than the first camera.
  if (perception.depth_camera && !c.robot.more_depth.empty()) {
    perception.depth_camera->range = range;
  }
  perception.depth_mapping.range = range;
  perception.start = start;
  return perception;
}

void clear_start(OccupancyMapper& map, const Configuration& c, const Pose& start) {
  map.clear_cylinder(start.position,
                     circumscribed_radius(c.robot.shape) + 0.75 * c.perception.mapping.resolution,
                     c.robot.slice().z_max - start.position.z());
}

}  // namespace prospect
