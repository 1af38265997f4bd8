#include "adapters/run/dds_run.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "adapters/dds/dds_base.h"
#include "adapters/dds/dds_node.h"
#include "adapters/dds/dds_publisher.h"
#include "adapters/dds/dds_sensors.h"
#include "adapters/files/input_error.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_guard.h"
#include "models/robot_shape.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/belief_source.h"
#include "runtime/clock.h"
#include "runtime/range_look.h"
#include "runtime/range_stop.h"
#include "runtime/sensor_inbox.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

constexpr double kWheelScale = 0.1;  // of wheels that nobody has calibrated: a standard deviation
constexpr double kPatience = 20.0;   // [s] that streams may take to become live

/// The robot with the cameras that its topics tell.
RobotDescription described(RobotDescription robot, const DdsCameras& cameras) {
  robot.stereo.left = cameras.stereo.left;
  robot.stereo.baseline = cameras.stereo.baseline;
  if (cameras.stereo_mount) robot.stereo_mount = *cameras.stereo_mount;
  if (cameras.depth) {
    robot.depth.horizontal_fov = cameras.depth->horizontal_fov();
    robot.depth.vertical_fov = cameras.depth->vertical_fov();
  }
  if (cameras.depth_mount) robot.depth_mount = *cameras.depth_mount;
  return robot;
}

PerceptionOptions perception_of(const Configuration& c, const DdsCameras& cameras,
                                const Pose& start) {
  PerceptionOptions perception;
  perception.stereo_mount = c.robot.stereo_mount;
  if (cameras.depth) {
    perception.depth_camera = DepthCameraOnBody{*cameras.depth, c.robot.depth_mount};
  }
  perception.mapping.map = c.simulator.mapping;
  const VerticalExtent slice = c.robot.slice();
  perception.mapping.map.slice.z_min = slice.z_min;
  perception.mapping.map.slice.z_max = slice.z_max;
  perception.mapping.map.slice.sight =
      c.robot.base_height() + c.robot.depth_mount.T_BC.translation().z();
  perception.mapping.map.max_range = c.robot.depth.max_range;
  perception.mapping.range = {c.robot.depth.min_range, c.robot.depth.max_range};
  perception.wheel_fusion.sigma_scale = kWheelScale;
  perception.max_age = std::min(perception.max_age, perception.wheel_fusion.max_wait);
  perception.start = start;
  return perception;
}

/// The streams of a robot that stands, once each has been live for as long as it must be, or after
/// kPatience. Nothing is sent to the base.
std::vector<PreflightFacts::Stream> watched_streams(Base& base, SensorInbox& inbox,
                                                    BeliefSource& beliefs, const Clock& clock,
                                                    const Guard::Options& limits,
                                                    SensorStream ranges,
                                                    const std::function<bool()>& cancelled) {
  const std::jthread perceives([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) beliefs.update(stop);
  });
  const std::array<SensorStream, 3> sources = {SensorStream::kPair, ranges, SensorStream::kWheels};
  std::vector<PreflightFacts::Stream> streams = {
      {"cameras", 0.0, limits.max_pose_age},
      {std::string(to_string(ranges)), 0.0, limits.max_ranges_age},
      {"wheels", 0.0, limits.max_pose_age}};
  const double begin = clock.now();
  std::array<double, 3> live_since{};
  live_since.fill(begin);
  while (clock.now() < begin + kPatience && !(cancelled && cancelled())) {
    for (const WheelSample& sample : base.report().wheels) inbox.wheels(sample);
    const double now = clock.now();
    bool live = true;
    for (std::size_t n = 0; n < streams.size(); ++n) {
      streams[n].age = now - inbox.count(sources[n]).newest.value_or(begin - kPatience);
      if (!(streams[n].age <= streams[n].limit)) live_since[n] = now;
      streams[n].live_for = now - live_since[n];
      live = live && streams[n].live_for > PreflightOptions().live_time;
    }
    if (live) break;
    clock.wait_until(now + 0.02, {});
  }
  return streams;
}

PreflightFacts preflight_facts(const Configuration& c, const Base& base,
                               const RealTimeOptions& driving) {
  PreflightFacts facts;
  facts.body = c.robot.slice();
  facts.resolution = c.simulator.mapping.resolution;
  facts.dead_man = base.dead_man();
  facts.longest_thread_limit =
      std::max({driving.perception_limit, driving.planner_limit, driving.command_limit});
  const BaseLimits limits = base.limits();
  facts.speed = {limits.speed, c.robot.model->max_speed()};
  facts.yaw_rate = {limits.yaw_rate, c.robot.model->max_yaw_rate()};
  facts.deceleration = {limits.acceleration, c.robot.model->max_deceleration()};
  return facts;
}

/// Of the robot's own shape, a disc about all of it.
RangeStopOptions range_stop_of(const RobotDescription& robot) {
  RangeStopOptions options;
  const double radius = circumscribed_radius(robot.shape);
  options.front = options.rear = options.left = options.right = options.corner_radius = radius;
  options.highest = std::max(options.lowest + 0.05, robot.slice().z_max - robot.base_height());
  options.deceleration = robot.model->max_deceleration();
  return options;
}

}  // namespace

DdsRunResult explore_dds(const Configuration& given, const DdsOptions& robot,
                         const DdsRunOptions& options) {
  Configuration c = given;
  const SolverRegistry builtin;
  const SteadyClock clock;
  SensorInbox inbox(clock, {});
  DdsNode node(robot.address);
  DdsBase base(robot, node, clock);
  const DdsSensors sensors(robot, node, inbox);
  DdsPublisher publisher(robot, node, base, clock, c.robot.model);
  node.start();
  const DdsCameras cameras = sensors.wait();
  c.robot = described(c.robot, cameras);
  Planner planner(c.robot, c.planner,
                  (options.solvers ? *options.solvers : builtin).make(c.solver));

  Pose start;
  start.position.z() = c.robot.base_height();
  const PerceptionOptions perceiving = perception_of(c, cameras, start);
  PerceptionPipeline perception(c.robot.stereo, perceiving);
  const OccupancyMapperOptions& mapping = perceiving.mapping.map;
  perception.map().clear_cylinder(start.position,
                                  circumscribed_radius(c.robot.shape) + 0.75 * mapping.resolution,
                                  mapping.slice.z_max - start.position.z());
  PipelineBeliefs beliefs(inbox, perception);
  Guard::Options limits = c.guard;
  limits.max_map_age = std::max(limits.max_map_age, 0.5);
  limits.max_ranges_age = std::max(limits.max_ranges_age, 0.5);
  const Guard guard = guard_for(c.robot, c.planner, limits);
  const RangeStop stop(range_stop_of(c.robot));
  const RangeCamera range_camera{cameras.depth.value_or(PinholeCamera()),
                                 c.robot.depth_mount,
                                 {robot.depth.min_range, robot.depth.max_range}};
  const RealTimeOptions driving;

  DdsRunResult result;
  const SensorStream ranges = cameras.depth ? SensorStream::kDepth : SensorStream::kScan;
  PreflightFacts facts = preflight_facts(c, base, driving);
  facts.streams = watched_streams(base, inbox, beliefs, clock, limits, ranges, options.cancelled);
  if (const std::vector<std::string> faults = base.report().faults; !faults.empty()) {
    throw InputError(faults);
  }
  result.preflight = checks_before_motion(facts);
  const std::string failed = first_failed(result.preflight);
  if (!failed.empty() || (options.cancelled && options.cancelled())) {
    result.mission.end = MissionEnd::kCancelled;
    result.mission.detail = failed.empty() ? "before the first motion"
                                           : "a check before the first motion failed: " + failed;
    result.faults = node.faults();
    return result;
  }

  RealTimeDriver driver({.clock = clock,
                         .base = base,
                         .beliefs = beliefs,
                         .planner = planner,
                         .guard = guard,
                         .model = c.robot.model,
                         .inbox = &inbox,
                         .ranges = range_look(inbox, stop, range_camera),
                         .failed_preflight = failed,
                         .yaw_checked = false},
                        driving);
  std::optional<Eigen::Vector3d> before;
  result.mission = driver.run(
      c.mission,
      [&](const MissionStep& step) {
        publisher.publish(step);
        const Eigen::Vector3d& at = step.belief->pose.position;
        if (before) result.path += (at - *before).head<2>().norm();
        before = at;
        if (options.on_step) options.on_step(step);
      },
      options.cancelled);
  result.driver = driver.status();
  result.events = driver.events().since(0).events;
  result.complaint = perception.complaint();
  result.faults = node.faults();
  result.map = perception.belief()->octree;
  return result;
}

}  // namespace prospect
