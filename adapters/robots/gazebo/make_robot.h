// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/faults/injected_fault.h"
#include "adapters/robots/gazebo/gazebo_options.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "engine/maps/grid.h"
#include "models/camera.h"
#include "models/robot_description.h"
#include "runtime/robot.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// What measures a robot in Gazebo.
struct GazeboMeasure {
  std::shared_ptr<const World> world;  ///< that Gazebo runs; null: nobody measures
  DepthCameraOptions looks{};          ///< of its depth cameras, in the world's voxels
  /// What of that world is to be seen from its start, which is the robot's.
  std::function<Grid<std::uint8_t>(const World&)> reachable{};
};

/// What a robot in the Gazebo that runs is made of.
struct GazeboRobotConfiguration {
  GazeboOptions gazebo;
  RobotDescription robot;
  SensorInboxOptions inbox{};
  std::vector<InjectedFault> faults{};  ///< but for those of planner and disk
  GazeboMeasure measure{};
};

/// It begins with the pose that Gazebo knows to be true; nothing else of the truth is used but to
/// measure. Its time is the simulation's (SimulationClock). It forks a process: make it before
/// threads. Throws InputError, one line, if no Gazebo answers, it has no such robot, or says
/// nothing of it; NotBuiltIn. The robot has not moved then.
Robot make_robot(const GazeboRobotConfiguration& options);

}  // namespace prospect
