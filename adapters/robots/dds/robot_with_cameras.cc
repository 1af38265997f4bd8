#include "adapters/robots/dds/robot_with_cameras.h"

#include <algorithm>

namespace prospect {

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
  if (cameras.lidar) {
    robot.depth.horizontal_fov = cameras.lidar->field_of_view;
    robot.depth.vertical_fov = 0.0;
    robot.depth.max_range = std::min(robot.depth.max_range, cameras.lidar->max_range);
    robot.depth.min_range = std::min(cameras.lidar->min_range, 0.5 * robot.depth.max_range);
    robot.depth_mount = cameras.lidar->mount;
  }
  robot.depth_mount = cameras.depth_mount.value_or(robot.depth_mount);
  return robot;
}

}  // namespace prospect
