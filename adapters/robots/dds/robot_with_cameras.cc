#include "adapters/robots/dds/robot_with_cameras.h"

namespace prospect {

RobotDescription robot_with(const DdsCameras& cameras, RobotDescription robot) {
  robot.stereo.left = cameras.stereo.left;
  robot.stereo.baseline = cameras.stereo.baseline;
  robot.stereo_mount = cameras.stereo_mount.value_or(robot.stereo_mount);
  if (cameras.depth) {
    robot.depth.horizontal_fov = cameras.depth->horizontal_fov();
    robot.depth.vertical_fov = cameras.depth->vertical_fov();
  }
  robot.depth_mount = cameras.depth_mount.value_or(robot.depth_mount);
  return robot;
}

}  // namespace prospect
