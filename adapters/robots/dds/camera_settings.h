#pragma once

#include <string>
#include <vector>

#include "adapters/robots/dds/dds_sensors.h"

namespace prospect {

/// What topics tell of the cameras, as settings of the robot (set_robot()): "robot.stereo.fx=450".
/// Focal lengths, principal point and size [px], baseline [m]; the depth camera's fields of view
/// [deg]; where tf tells of mounts, position in B [m] and angles [deg]. What topics do not tell is
/// left as it is.
std::vector<std::string> camera_settings(const DdsCameras& cameras);

}  // namespace prospect
