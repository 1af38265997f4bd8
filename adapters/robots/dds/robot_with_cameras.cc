// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/robot_with_cameras.h"

#include <algorithm>

namespace prospect {
namespace {

void see_by(const DdsLidar& lidar, RgbdFootprint& footprint, CameraMount& mount) {
  footprint.horizontal_fov = lidar.field_of_view;
  footprint.vertical_fov = 0.0;
  footprint.max_range = std::min(footprint.max_range, lidar.max_range);
  footprint.min_range = std::min(lidar.min_range, 0.5 * footprint.max_range);
  mount = lidar.mount;
}

}  // namespace

RobotDescription robot_with(const DdsCameras& cameras, RobotDescription robot) {
  if (cameras.stereo) {
    robot.stereo.left = cameras.stereo->left;
    robot.stereo.baseline = cameras.stereo->baseline;
  }
  robot.stereo_mount = cameras.stereo_mount.value_or(robot.stereo_mount);
  if (cameras.depth) {
    robot.depth.horizontal_fov = cameras.depth->horizontal_fov();
    robot.depth.vertical_fov = cameras.depth->vertical_fov();
  }
  if (cameras.lidar) see_by(*cameras.lidar, robot.depth, robot.depth_mount);
  robot.depth_mount = cameras.depth_mount.value_or(robot.depth_mount);
  for (std::size_t n = 0; n < robot.more_depth.size(); ++n) {
    const auto sensor = static_cast<int>(n) + 1;
    auto& [footprint, mount] = robot.more_depth[n];
    if (const auto camera = cameras.more_depth.find(sensor); camera != cameras.more_depth.end()) {
      footprint.horizontal_fov = camera->second.horizontal_fov();
      footprint.vertical_fov = camera->second.vertical_fov();
    }
    const auto lidar = cameras.more_lidars.find(sensor);
    if (lidar != cameras.more_lidars.end()) see_by(lidar->second, footprint, mount);
    const auto place = cameras.more_mounts.find(sensor);
    if (place != cameras.more_mounts.end()) mount = place->second;
  }
  return robot;
}

}  // namespace prospect
