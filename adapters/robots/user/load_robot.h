// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "runtime/plugin_robot.h"

namespace prospect {

/// The robot of the plug-in `path`, whose PluginAbi is this program's (solvers/load_plugin.h).
/// Throws std::invalid_argument, one line `plug-in 'path': what; expected what`, for another
/// RobotAbi, a describe() that is missing or throws, and as check() (joined_robots.h).
UserRobot load_robot(const PluginRobot& offer, const std::string& path);

}  // namespace prospect
