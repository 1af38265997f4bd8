#include "adapters/missions/run/gazebo_run.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/run/live_mission.h"
#include "adapters/missions/run/live_perception.h"
#include "adapters/missions/run/run_recorder.h"
#include "adapters/missions/run/true_run.h"
#include "adapters/missions/run/unmeasured.h"
#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/faults/faulty_disk.h"
#include "adapters/robots/faults/faulty_frames.h"
#include "adapters/robots/faults/faulty_replanner.h"
#include "adapters/robots/gazebo/gazebo_base.h"
#include "adapters/robots/gazebo/gazebo_robot_model.h"
#include "adapters/robots/gazebo/gazebo_sensors.h"
#include "adapters/robots/gazebo/gazebo_truth.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_guard.h"
#include "models/reason.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/range_check.h"
#include "runtime/range_stop.h"
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

/// As Gazebo renders it: square pixels, the principal point in the middle.
PinholeCamera depth_camera_of(const RobotDescription& robot, const GazeboOptions& options) {
  const int width = options.depth_width;
  const int height = static_cast<int>(std::lround(width * std::tan(0.5 * robot.depth.vertical_fov) /
                                                  std::tan(0.5 * robot.depth.horizontal_fov)));
  PinholeCamera camera = depth_camera(robot.depth, width, std::max(1, height));
  camera.fy = camera.fx;
  return camera;
}

}  // namespace

ExplorationRunResult explore_gazebo(const Configuration& given,
                                    const std::shared_ptr<const World>& measured,
                                    const ExplorationRunOptions& options) {
  Configuration c = given;
  set_robot(c, gazebo_camera_settings(c.robot.stereo), "Gazebo's cameras:");
  check_drives(c);
  const SteadyClock machine;
  SimulationClock clock(machine);
  GazeboBase base(c.gazebo, clock);  // before threads, as it forks
  const std::unique_ptr<Replanner> planner = planner_for(c, options);

  std::optional<GazeboTruth> truth(std::in_place, c.gazebo);
  const GazeboTruth::Stamped first = first_pose(*truth, c.gazebo);
  const std::vector<InjectedFault> faults =
      options.real_time ? options.real_time->faults : std::vector<InjectedFault>();
  FaultyBase faulty_base(base, clock, faults, first.stamp);
  const FaultyDisk disk(clock, faults, first.stamp);
  FaultyReplanner faulty_planner(*planner, *c.robot.model, clock, faults, first.stamp);
  SensorInboxOptions inbox_options = c.drive.inbox;
  inbox_options.cameras_in_runtime_clock = inbox_options.wheels_in_runtime_clock =
      inbox_options.depth_in_runtime_clock = true;
  SensorInbox inbox(clock, FaultyFrames::inbox_options(inbox_options, faults));
  FaultyFrames frames(clock, inbox, faults, first.stamp, c.gazebo.depth_range);
  const GazeboSensors sensors(
      c.gazebo, clock,
      {[&](double stamp, ImagePair images) { frames.pair(stamp, std::move(images)); },
       [&](double stamp, DepthImage image) { frames.depth(stamp, std::move(image)); }});
  Pose start = first.pose;
  start.position.z() = c.robot.base_height();
  if (!measured) truth.reset();
  // What can be reached is reached from there.
  std::optional<World> world;
  if (measured) {
    world.emplace(*measured).start = start;
    world->start.position.z() = measured->start.position.z();
  }

  const RangeCamera depth{depth_camera_of(c.robot, c.gazebo),
                          c.robot.depth_mount,
                          {c.robot.depth.min_range, c.robot.depth.max_range}};
  PerceptionPipeline perception(c.robot.stereo, live_perception(c, depth, start));
  clear_start(perception.map(), c, start);
  PictureTap pictures(options.taps, perception);
  PipelineBeliefs beliefs(inbox, perception, pictures.frames());
  const Guard guard = guard_for(c.robot, c.planner, c.guard);
  const RangeStop stop(c.drive.ranges);

  std::optional<TrueRun> true_run;
  if (world) true_run.emplace(*world, c, std::move(*truth));
  Unmeasured unmeasured;
  const auto known = [&] { return true_run ? true_run->truth() : unmeasured.truth(); };

  LiveRobot robot{
      .clock = clock,
      .base = faulty_base,
      .beliefs = beliefs,
      .planner = faulty_planner,
      .guard = guard,
      .inbox = &inbox,
      .streams = {watched(inbox, SensorStream::kPair, "cameras", c.guard.max_pose_age),
                  watched(inbox, SensorStream::kDepth, "depth", c.guard.max_ranges_age),
                  watched(inbox, SensorStream::kWheels, "wheels", c.guard.max_pose_age)},
      .ranges = range_check(inbox, stop, depth),
      .floor = newest_floor(inbox, depth, c.robot.base_height()),
      .on_perceived = pictures.perceived()};
  RunRecorder recorder(c, options, dynamic_cast<const Planner*>(planner.get()));
  if (options.on_start) options.on_start(c);
  ExplorationRunResult result;
  const auto observe = [&](const MissionStep& step) {
    disk.write();
    const SimulatedTruth estimated = unmeasured.at(step);
    recorder.add(step, true_run ? true_run->at(*step.belief) : estimated);
  };
  const double begun = clock.now(), begun_by_machine = machine.now();
  const MissionResult mission =
      live_mission(robot, c, mission_options_for(c, known), observe, options, result);
  if (!faults.empty()) result.faults_start = first.stamp;
  result.real_time_factor = (clock.now() - begun) / (machine.now() - begun_by_machine);
  SimulatedTruth at_end = known();
  at_end.losses = unmeasured.truth().losses;
  result.record = recorder.finish(mission, measured ? measured->name : base.world(), at_end,
                                  true_run ? &true_run->reachable() : nullptr);
  result.record.summary.measured = measured != nullptr;
  result.map = perception.belief()->octree;
  result.complaint = perception.complaint();
  for (const std::string& fault : sensors.faults()) add_reason(result.complaint, fault);
  return result;
}

}  // namespace prospect
