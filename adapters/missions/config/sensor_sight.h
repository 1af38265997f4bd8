// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "models/camera.h"
#include "models/robot_description.h"
#include "models/robot_shape.h"

namespace prospect {

/// Lowest and highest place above the floor [m] that rays of a depth sensor pass where nothing is
/// in their way: h + s d_z over all directions d of the footprint and 0 <= s <= max_range, with the
/// sensor at height h. Of a sensor of one level plane both are h.
VerticalExtent heights_of_rays(const RgbdFootprint& footprint, const CameraMount& mount,
                               double base_height);

/// "" if rays of a depth sensor of the robot pass layers of voxels that the ground map is read from
/// (slice_layers() of the body), else what is wrong. Such a sensor shows nothing of the ground, and
/// the planner would count on it. A base that moves in 3-D looks everywhere.
std::string sight_problem(const RobotDescription& robot, const DepthSensor& sensor,
                          double resolution);

}  // namespace prospect
