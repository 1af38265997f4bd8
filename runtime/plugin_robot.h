// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "runtime/user_robot.h"

/// A robot, or a part of one, in a shared library: `prospect drive --base plugin:lib.so`. A plug-in
/// as any (solvers/plugin.h) whose Plugin::robot points to one of these; docs/examples/create2 is a
/// whole example, docs/tutorials/your_base.md explains it.
///
/// May cross besides: the UserRobot by value, its drivers and their calls, frames and reports. An
/// exception of a driver becomes a fault of the robot, one of describe() a refusal, one of
/// UserRobot::make bad input.
namespace prospect {

/// Sizes [byte] of what crosses the border. Beside PluginAbi, which comes first.
struct RobotAbi {
  std::int32_t robot, drivers, report, limits, wheels, frame, depth, scan, image, pose, imu,
      emergency_stop;

  bool operator==(const RobotAbi&) const = default;
};
constexpr RobotAbi kRobotAbi = {
    static_cast<std::int32_t>(sizeof(UserRobot)),
    static_cast<std::int32_t>(sizeof(RobotDrivers)),
    static_cast<std::int32_t>(sizeof(BaseReport)),
    static_cast<std::int32_t>(sizeof(BaseLimits)),
    static_cast<std::int32_t>(sizeof(WheelSample)),
    static_cast<std::int32_t>(sizeof(SensorFrame)),
    static_cast<std::int32_t>(sizeof(DepthImage)),
    static_cast<std::int32_t>(sizeof(DepthScan)),
    static_cast<std::int32_t>(sizeof(Image)),
    static_cast<std::int32_t>(sizeof(ExternalPose)),
    static_cast<std::int32_t>(sizeof(ImuSample)),
    static_cast<std::int32_t>(sizeof(EmergencyStopInput)),
};

/// The robot of a plug-in.
struct PluginRobot {
  RobotAbi abi;             ///< kRobotAbi; first in every version
  const char* description;  ///< one sentence, for `prospect list bases`
  UserRobot (*describe)();  ///< called once, when the plug-in is loaded; makes nothing yet
};

}  // namespace prospect
