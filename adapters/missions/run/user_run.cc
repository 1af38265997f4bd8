// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/user_run.h"

#include "adapters/missions/run/live_mission.h"
#include "adapters/robots/user/joined_robots.h"
#include "adapters/robots/user/make_robot.h"

namespace prospect {

ExplorationRunResult explore_user(const Configuration& c, const UserRobot& user,
                                  const ExplorationRunOptions& options) {
  check_drives(c);
  check_streams(user);
  UserRobotConfiguration made{.user = user,
                              .robot = c.robot,
                              .options = c.base,
                              .priority = c.drive.driver.priority,
                              .inbox = inbox_of(c)};
  if (options.real_time) made.faults = options.real_time->faults;
  return live_mission(make_robot(made), c, c.guard, nullptr, options);
}

}  // namespace prospect
