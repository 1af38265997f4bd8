// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/robots/dds/dds_options.h"
#include "adapters/robots/faults/injected_fault.h"
#include "models/robot_description.h"
#include "runtime/drive_requests.h"
#include "runtime/robot.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// What a robot behind topics of ROS 2 is made of.
struct DdsRobotConfiguration {
  DdsOptions topics;
  RobotDescription robot;
  SensorInboxOptions inbox{};
  DriveRequests* requests = nullptr;  ///< as of DdsBase; null: nobody
  /// But for those of planner and disk; their times count from when it is made.
  std::vector<InjectedFault> faults{};
};

/// It begins at the origin of W, looking along x; one that is told its pose, where that says.
/// Its settings are what its topics say of its
/// cameras; each step of its mission is published (DdsPublisher). Throws InputError, a line each,
/// for calibrations and transforms that do not come and topics that do not fit; NotBuiltIn. Nothing
/// has been sent to the base then.
Robot make_robot(const DdsRobotConfiguration& options);

}  // namespace prospect
