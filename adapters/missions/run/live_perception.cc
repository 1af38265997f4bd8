#include "adapters/missions/run/live_perception.h"

#include "models/robot_shape.h"

namespace prospect {

PerceptionOptions live_perception(const Configuration& c, const std::optional<RangeCamera>& depth,
                                  const Pose& start) {
  PerceptionOptions perception = c.perception;
  perception.stereo_mount = c.robot.stereo_mount;
  const DepthRange range =
      depth ? depth->range : DepthRange{c.robot.depth.min_range, c.robot.depth.max_range};
  const CameraMount& mount = depth ? depth->mount : c.robot.depth_mount;
  if (depth) perception.depth_camera = {depth->camera, mount};
  const VerticalExtent slice = c.robot.slice();
  perception.mapping.slice.z_min = slice.z_min;
  perception.mapping.slice.z_max = slice.z_max;
  perception.mapping.slice.sight = c.robot.base_height() + mount.T_BC.translation().z();
  perception.mapping.max_range = range.max;
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
