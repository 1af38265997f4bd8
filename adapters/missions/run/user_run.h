// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "runtime/user_robot.h"

namespace prospect {

/// A mission on a user's robot, in real time. The configuration holds what the robot tells of
/// itself (UserRobot::settings). Nobody knows the world: what is true is unknown in the records
/// (Summary::measured). Faults of options.real_time are injected, in the time since the robot was
/// made.
///
/// Throws as UserRobot::make and live_mission().
ExplorationRunResult explore_user(const Configuration& configuration, const UserRobot& robot,
                                  const ExplorationRunOptions& options);

}  // namespace prospect
