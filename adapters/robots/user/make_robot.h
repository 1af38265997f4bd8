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
  SensorInboxOptions inbox{};
  std::vector<InjectedFault> faults{};  ///< but for those of planner and disk
};

/// It is on the machine's clock; its sensors deliver from a thread that ends with it. Throws what
/// UserRobot::make does, and std::invalid_argument for drivers that it does not give.
Robot make_robot(const UserRobotConfiguration& options);

}  // namespace prospect
