// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/load_robot.h"

#include <exception>
#include <stdexcept>

#include "adapters/robots/user/joined_robots.h"

namespace prospect {

UserRobot load_robot(const PluginRobot& offer, const std::string& path) {
  const std::string subject = "plug-in '" + path + "': ";
  if (offer.abi != kRobotAbi) {
    throw std::invalid_argument(
        subject +
        "its robot was built with other sizes of drivers, frames or reports; expected "
        "those of this program: build it anew");
  }
  if (!offer.describe)
    throw std::invalid_argument(subject + "its robot has no describe(); expected one");
  try {
    UserRobot robot = offer.describe();
    check(robot);
    return robot;
  } catch (const std::exception& e) {
    throw std::invalid_argument(subject + "its robot failed: " + e.what());
  } catch (...) {
    throw std::invalid_argument(subject +
                                "its robot failed: an exception that is not a std::exception");
  }
}

}  // namespace prospect
