#include "adapters/missions/run/gazebo_run.h"

#include <optional>

#include "adapters/missions/run/live_mission.h"
#include "adapters/robots/gazebo/make_robot.h"

namespace prospect {

ExplorationRunResult explore_gazebo(const Configuration& given,
                                    const std::shared_ptr<const World>& measured,
                                    const ExplorationRunOptions& options) {
  check_drives(given);
  Configuration c = given;
  std::optional<ReachableArea> reachable;
  GazeboRobotConfiguration gazebo{.gazebo = c.gazebo, .robot = c.robot, .inbox = c.drive.inbox};
  if (options.real_time) gazebo.faults = options.real_time->faults;
  gazebo.measure = {measured, c.simulator.depth, [&](const World& from_its_start) {
                      reachable = told_area(reachable_area(from_its_start, given), given);
                      return reachable->cells;
                    }};
  const Robot robot = make_robot(gazebo);
  take_settings(robot, c);
  return live_mission(robot, c, c.guard, reachable ? &*reachable : nullptr, options);
}

}  // namespace prospect
