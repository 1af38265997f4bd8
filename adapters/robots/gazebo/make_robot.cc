// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/make_robot.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/faults/faulty_frames.h"
#include "adapters/robots/gazebo/gazebo_base.h"
#include "adapters/robots/gazebo/gazebo_robot_model.h"
#include "adapters/robots/gazebo/gazebo_sensors.h"
#include "adapters/robots/gazebo/gazebo_truth.h"
#include "adapters/robots/gazebo/true_run.h"
#include "runtime/simulation_clock.h"

namespace prospect {
namespace {

/// The first pose that Gazebo tells. Throws InputError if none comes.
GazeboTruth::Stamped first_pose(GazeboTruth& truth, const GazeboOptions& options) {
  const SteadyClock clock;
  const double end = clock.now() + options.address.timeout;
  while (clock.now() < end) {
    const auto poses = truth.take();
    if (!poses.empty()) return poses.front();
    clock.wait_until(clock.now() + 0.01, {});
  }
  throw InputError("gazebo.model: no pose of '" + options.model + "' within " +
                   std::to_string(static_cast<int>(std::lround(options.address.timeout))) +
                   " s; expected a model of that name in a world that runs");
}

/// All that the robot's pointers share.
struct GazeboParts {
  explicit GazeboParts(const GazeboRobotConfiguration& o)
      : clock(machine),
        base(o.gazebo, clock),
        truth(std::in_place, o.gazebo),
        first(first_pose(*truth, o.gazebo)),
        faulty_base(base, clock, o.faults, first.stamp),
        inbox(clock, FaultyFrames::inbox_options(in_runtime_clock(o.inbox), o.faults)),
        frames(clock, inbox, o.faults, first.stamp, o.gazebo.depth_range),
        sensors(with_sensors_of(o.gazebo, o.robot), clock, frames) {}

  const SteadyClock machine;
  SimulationClock clock;
  GazeboBase base;  // before threads, as it forks
  std::optional<GazeboTruth> truth;
  const GazeboTruth::Stamped first;
  FaultyBase faulty_base;
  SensorInbox inbox;
  FaultyFrames frames;
  const GazeboSensors sensors;  // their thread ends first
  std::optional<World> world;   // with the robot's start
  std::optional<TrueRun> true_run;
};

}  // namespace

Robot make_robot(const GazeboRobotConfiguration& options) {
  std::map<int, PinholeCamera> cameras = gazebo_depth_cameras(options.robot, options.gazebo);
  const auto parts = std::make_shared<GazeboParts>(options);
  Robot robot;
  robot.clock = {parts, &parts->clock};
  robot.base = {parts, &parts->faulty_base};
  robot.frames = {parts, &parts->inbox};
  robot.streams = {SensorStream::kPair, SensorStream::kDepth, SensorStream::kWheels};
  if (!options.gazebo.imu.empty()) robot.streams.push_back(SensorStream::kImu);
  robot.start = parts->first.pose;
  robot.start.position.z() = options.robot.base_height();
  robot.made = parts->first.stamp;
  robot.simulated_time = true;
  if (const auto first = cameras.extract(0)) robot.depth = first.mapped();
  robot.more_depth = std::move(cameras);
  robot.description = gazebo_robot(options.robot);
  robot.described_by = "Gazebo's cameras";
  robot.link_faults = [parts] { return parts->sensors.faults(); };
  if (const World* measured = options.measure.world.get()) {
    // What can be reached is reached from there.
    World& world = parts->world.emplace(*measured);
    world.start = robot.start;
    world.start.position.z() = measured->start.position.z();
    parts->true_run.emplace(world, options.robot, options.measure.looks,
                            options.measure.reachable(world),
                            [truth = std::make_shared<GazeboTruth>(std::move(*parts->truth))] {
                              return truth->take();
                            });
    robot.truth = {parts, &*parts->true_run};
    robot.name = measured->name;
  } else {
    robot.name = parts->base.world();
  }
  parts->truth.reset();
  return robot;
}

}  // namespace prospect
