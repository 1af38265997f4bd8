// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "models/camera.h"
#include "models/robot_description.h"
#include "models/types.h"

namespace prospect {

struct GazeboRobotOptions {
  GazeboOptions names;       ///< and what the wheels are
  double image_rate = 15.0;  ///< [Hz] of stereo pairs
  double depth_rate = 10.0;  ///< [Hz]
};

/// The robot as a <model> of SDF 1.5 or newer: a differential drive with DiffDrivePlugin, whose
/// link `base` is the body frame B; a multicamera of the stereo pair, its depth cameras, two
/// wheels, two casters without friction. Its cameras have no noise, which Gazebo would draw from no
/// seed (GazeboImageNoise). It stands at start, with z [m] the height of the floor in the world. It
/// cannot be seen, so that its cameras do not see it.
///
/// Errors: std::invalid_argument on options out of range, a body that is neither a cylinder nor a
/// box, or a stereo pair whose pixels are not square: Gazebo's are, with the principal point in the
/// middle. InputError as check(GazeboOptions).
std::string gazebo_robot_model(const RobotDescription& robot, const GazeboRobotOptions& options,
                               const Pose& start);

/// With so many depth cameras as it has.
GazeboOptions with_sensors_of(GazeboOptions options, const RobotDescription& robot);

/// Its depth cameras by their number, as Gazebo renders them: square pixels, the principal point in
/// the middle. None if the options name none. Throws InputError for a sensor that is no camera.
std::map<int, PinholeCamera> gazebo_depth_cameras(const RobotDescription& robot,
                                                  const GazeboOptions& options);

/// The robot as Gazebo renders its cameras: the principal point at
/// ((width - 1) / 2, (height - 1) / 2) [px].
RobotDescription gazebo_robot(RobotDescription robot);

}  // namespace prospect
