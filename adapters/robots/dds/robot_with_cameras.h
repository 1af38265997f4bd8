// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/robots/dds/dds_sensors.h"
#include "models/robot_description.h"

namespace prospect {

/// The robot with what topics tell of its cameras: focal lengths, principal point and size [px],
/// baseline [m], the depth camera's fields of view [rad]; where tf tells of mounts, these. A lidar
/// tells its field of view, its place and its ranges, of which the longest is no longer than the
/// robot's was. What
/// topics do not tell is left as it is.
RobotDescription robot_with(const DdsCameras& cameras, RobotDescription robot);

}  // namespace prospect
