// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/robots/faults/injected_fault.h"
#include "models/robot_description.h"
#include "runtime/robot.h"
#include "runtime/sensor_inbox.h"
#include "runtime/user_robot.h"

namespace prospect {

/// What a user's robot is made of.
struct UserRobotConfiguration {
  const UserRobot& user;
  RobotDescription robot;
  Options options{};  ///< all that the robot has, as told
  int priority = 0;   ///< of the thread on which its base is called (realtime_priority.h)
  SensorInboxOptions inbox{};
  std::vector<InjectedFault> faults{};  ///< but for those of planner and disk
};

/// It is on the machine's clock. Its drivers run on threads of their own, which end with it: a base
/// is called by a ThreadedBase, each source of sensors delivers from a thread. Throws what
/// UserRobot::make does, and std::invalid_argument for drivers that it does not give.
Robot make_robot(const UserRobotConfiguration& options);

}  // namespace prospect
