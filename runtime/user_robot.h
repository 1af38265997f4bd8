// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/problem/solver.h"
#include "models/camera.h"
#include "models/types.h"
#include "runtime/base.h"
#include "runtime/emergency_stop.h"
#include "runtime/sensor_inbox.h"
#include "runtime/sensor_source.h"

namespace prospect {

/// What works a robot of one's own. One object may be both base and sensors.
struct RobotDrivers {
  std::shared_ptr<Base> base;
  std::vector<std::shared_ptr<SensorSource>> sensors;    ///< a localization is one, too
  std::shared_ptr<EmergencyStopInput> emergency_stop{};  ///< null: nobody presses one
};

/// A robot of one's own: what it is, and how it is made. All else (perception, planner, guard,
/// checks, records) is Prospect's. A program gives it to run_robot(), a shared library offers it as
/// a plug-in (runtime/plugin_robot.h). Several parts may be one robot (adapters/robots/user/
/// joined_robots.h): a base by one, sensors by another.
///
/// Perception is by what the sensors deliver: `streams` are those that the robot needs, and cannot
/// go without. With stereo pairs poses are those of visual odometry, with wheels where they turn;
/// without, they come from outside (kPose), or, with kWheels and no kPose, of the wheels alone that
/// its base reports. Depth images or scans make the map. An IMU (kImu) is a witness of how it
/// turns.
struct UserRobot {
  std::string name = "robot";  ///< for records: letters, digits, _ and -
  std::vector<SensorStream> streams{};
  /// What else is to be known of it: keys of the configuration, "robot.motion.v_max=0.5". They
  /// stand above a configuration file, and below what is told on the command line.
  std::vector<std::string> settings{};
  /// What its drivers can be told: keys of the configuration, too, `base.NAME`, of the type of
  /// their defaults. Names are letters, digits and _.
  std::vector<OptionInfo> options{};
  std::optional<PinholeCamera> depth{};  ///< of its depth images
  /// Its depth sensors besides that one are what the configuration has as robot.more_depth; all are
  /// needed, and their frames have the numbers 1, 2 and so on (DepthFrame::sensor). Here the
  /// cameras of those with depth images, by their number; the others have scans.
  std::map<int, PinholeCamera> more_depth{};
  Pose start{};  ///< of B in W when it is made; the place that its body takes up there is free
  /// Called once, before any thread of Prospect, once nothing else is amiss, with all options. What
  /// it throws ends the program: std::invalid_argument as bad input, in one line.
  std::function<RobotDrivers(const Options& options)> make;
};

}  // namespace prospect
