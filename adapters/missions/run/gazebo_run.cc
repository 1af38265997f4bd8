// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/gazebo_run.h"

#include <map>
#include <optional>
#include <utility>

#include "adapters/missions/run/live_mission.h"
#include "adapters/missions/run/live_perception.h"
#include "adapters/missions/run/lockstep_mission.h"
#include "adapters/robots/gazebo/gazebo_lockstep.h"
#include "adapters/robots/gazebo/gazebo_robot_model.h"
#include "adapters/robots/gazebo/make_robot.h"
#include "adapters/robots/gazebo/true_run.h"

namespace prospect {
namespace {

/// The Gazebo that stands, stepped by the mission.
ExplorationRunResult step_gazebo(Configuration c, const GazeboMeasure& measure,
                                 const std::optional<ReachableArea>& reachable,
                                 const ExplorationRunOptions& options) {
  const std::map<int, PinholeCamera> cameras = gazebo_depth_cameras(c.robot, c.gazebo);
  SteppedGazebo gazebo(with_sensors_of(c.gazebo, c.robot));
  set_cameras(c, gazebo_robot(c.robot), "Gazebo's cameras");
  check_drives(c);
  Pose start = gazebo.start();
  start.position.z() = c.robot.base_height();
  const RangeCameras depth = range_cameras(cameras, c.robot);
  PerceptionPipeline perception(c.robot.stereo, live_perception(c, depth, start));
  clear_start(perception.map(), c, start);
  GazeboLockstep robot(gazebo, perception);
  LockstepRun run{.name = gazebo.world()};
  std::optional<World> world;
  std::optional<TrueRun> truth;
  if (measure.world) {
    world = *measure.world;
    world->start = start;
    world->start.position.z() = measure.world->start.position.z();
    const Grid<std::uint8_t> cells = measure.reachable(*world);
    truth.emplace(*world, c.robot, measure.looks, cells, [&] { return robot.take_truth(); });
    run = {measure.world->name, &*truth, &*reachable};
  }
  return lockstep_mission(robot, run, c, c.guard, options);
}

}  // namespace

ExplorationRunResult explore_gazebo(const Configuration& given,
                                    const std::shared_ptr<const World>& measured,
                                    const ExplorationRunOptions& options) {
  check_drives(given);
  Configuration c = given;
  c.gazebo.seed = options.seed;
  std::optional<ReachableArea> reachable;
  const GazeboMeasure measure{measured, c.simulator.depth, [&](const World& from_its_start) {
                                reachable = told_area(reachable_area(from_its_start, given), given);
                                return reachable->cells;
                              }};
  if (!options.real_time) return step_gazebo(std::move(c), measure, reachable, options);
  GazeboRobotConfiguration gazebo{.gazebo = c.gazebo,
                                  .robot = c.robot,
                                  .inbox = c.drive.inbox,
                                  .faults = options.real_time->faults,
                                  .measure = measure};
  const Robot robot = make_robot(gazebo);
  take_settings(robot, c);
  return live_mission(robot, c, c.guard, reachable ? &*reachable : nullptr, options);
}

}  // namespace prospect
