// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/live_mission.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adapters/missions/run/live_perception.h"
#include "adapters/missions/run/run_recorder.h"
#include "adapters/robots/faults/faulty_disk.h"
#include "adapters/robots/faults/faulty_replanner.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_guard.h"
#include "models/formatted.h"
#include "models/reason.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/driver.h"
#include "runtime/preflight_run.h"
#include "runtime/range_check.h"
#include "runtime/range_stop.h"
#include "runtime/seen_floor.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

/// The hits of a scan as the camera would see them.
DepthImage depth_image(const DepthScan& in_B, const RangeCamera& c) {
  DepthImage image(static_cast<int>(c.camera.width), static_cast<int>(c.camera.height));
  const Eigen::Isometry3d T_CB = c.mount.T_BC.inverse();
  for (const Eigen::Vector3d& hit : in_B.hits) {
    const Eigen::Vector3d p = T_CB * hit;
    if (!(p.z() > 0.0)) continue;
    const int u = static_cast<int>(std::lround(c.camera.cx + c.camera.fx * p.x() / p.z()));
    const int v = static_cast<int>(std::lround(c.camera.cy + c.camera.fy * p.y() / p.z()));
    if (u < 0 || u >= image.width || v < 0 || v >= image.height) continue;
    image.at(u, v) = static_cast<float>(p.z());
  }
  return image;
}

/// The floor as the newest ranges show it; none: there are none yet.
std::optional<PreflightFacts::Floor> floor_in(const SensorInbox& inbox, const RangeCamera& depth,
                                              double base_height) {
  const NewestRanges newest = inbox.ranges();
  if (!newest.depth.image && !newest.scan.in_B) return std::nullopt;
  return seen_floor(
      newest.depth.image ? *newest.depth.image : depth_image(*newest.scan.in_B, depth),
      depth.camera, depth.mount, base_height, depth.range);
}

/// What pre-flight waits for. A robot that perceives by itself stamps its beliefs. sensors: how
/// many depth sensors it has.
std::vector<WatchedStream> streams_of(const Robot& robot, std::size_t sensors,
                                      const Guard::Options& limits, double max_imu_age) {
  std::vector<WatchedStream> streams;
  if (robot.beliefs) {
    const auto stamp = [](double SourceStamps::*of) {
      return [of](const Belief* newest) {
        return newest ? std::optional(newest->stamps.*of) : std::nullopt;
      };
    };
    streams = {{"cameras", limits.max_pose_age, stamp(&SourceStamps::pose)},
               {"depth", limits.max_ranges_age, stamp(&SourceStamps::ranges)}};
  }
  for (const SensorStream stream : robot.streams) {
    const bool ranges = stream == SensorStream::kDepth || stream == SensorStream::kScan;
    const bool pairs = stream == SensorStream::kPair;
    const bool imu = stream == SensorStream::kImu;
    streams.push_back(watched(*robot.frames, stream,
                              pairs ? "cameras" : std::string(to_string(stream)),
                              ranges ? limits.max_ranges_age
                              : imu  ? max_imu_age
                                     : limits.max_pose_age));
  }
  for (int n = 1; !robot.beliefs && n < static_cast<int>(sensors); ++n) {
    streams.push_back(watched_sensor(*robot.frames, n, limits.max_ranges_age));
  }
  return streams;
}

/// Of what it sees depth images with.
RangeCameras cameras_of(const Robot& robot, const RobotDescription& description) {
  const auto sensors = static_cast<int>(description.depth_sensors().size());
  std::map<int, PinholeCamera> cameras = robot.more_depth;
  for (const auto& [number, camera] : cameras) {
    if (number >= 1 && number < sensors) continue;
    throw std::invalid_argument("depth camera " + std::to_string(number) + " of the robot '" +
                                robot.name + "' is none of the " + std::to_string(sensors) +
                                " depth sensors of the configuration; expected it in "
                                "robot.more_depth");
  }
  if (robot.depth) cameras[0] = *robot.depth;
  return range_cameras(cameras, description);
}

bool has(const Robot& robot, SensorStream stream) {
  return std::find(robot.streams.begin(), robot.streams.end(), stream) != robot.streams.end();
}
/// Whether it has stereo pairs, by which it localizes itself.
bool has_pairs(const Robot& robot) { return robot.beliefs || has(robot, SensorStream::kPair); }

/// Whether its pose is that of its wheels alone.
bool goes_by_wheels(const Robot& robot) {
  return !has_pairs(robot) && has(robot, SensorStream::kWheels) && !has(robot, SensorStream::kPose);
}

PerceptionPipeline pipeline_of(const Robot& robot, const Configuration& c,
                               const RangeCameras& depth) {
  PerceptionOptions options = live_perception(c, depth, robot.start);
  if (has_pairs(robot)) return PerceptionPipeline(c.robot.stereo, options);
  // Its pose comes from outside, or of its wheels alone.
  options.wheels = goes_by_wheels(robot);
  return PerceptionPipeline(options);
}

/// Perception of a robot that has none of its own.
struct OwnPerception {
  OwnPerception(const Robot& robot, const Configuration& c, const RangeCameras& depth)
      : perception(pipeline_of(robot, c, depth)), beliefs(*robot.frames, perception) {
    clear_start(perception.map(), c, robot.start);
  }
  PerceptionPipeline perception;
  PipelineBeliefs beliefs;
};

/// Drives if no check has failed.
MissionResult drive_if_fit(Driver& driver, const std::vector<CheckResult>& checks,
                           const Robot& robot, BeliefSource& beliefs,
                           const std::function<bool()>& cancelled) {
  const std::string failed = first_failed(checks);
  if (failed.empty()) return driver.run(*robot.base, beliefs);
  MissionResult end;
  end.end = cancelled && cancelled() ? MissionEnd::kCancelled : MissionEnd::kNotFit;
  for (const CheckResult& check : checks) {
    if (check.check == failed) {
      end.detail = "before the first motion: " + check.check + ": " + check.why;
    }
  }
  return end;
}

}  // namespace

void take_settings(const Robot& robot, Configuration& c) {
  if (robot.description.model) set_cameras(c, robot.description, robot.described_by);
  check_drives(c);
}

ExplorationRunResult live_mission(const Robot& robot, const Configuration& c,
                                  const Guard::Options& limits, const ReachableArea* reachable,
                                  const ExplorationRunOptions& options) {
  const std::unique_ptr<Replanner> planner = planner_for(c, options);
  Guard::Options ages = limits;
  if (!has_pairs(robot)) ages.max_landmarks_age = std::numeric_limits<double>::infinity();
  const Guard guard = guard_for(c.robot, c.planner, ages);
  const RangeCameras depth = cameras_of(robot, c.robot);
  std::optional<OwnPerception> own;
  if (!robot.beliefs) own.emplace(robot, c, depth);
  BeliefSource& beliefs = own ? own->beliefs : *robot.beliefs;
  const RangeStop stop(c.drive.ranges);
  const std::vector<InjectedFault> faults =
      options.real_time ? options.real_time->faults : std::vector<InjectedFault>();
  FaultyReplanner faulty_planner(*planner, *c.robot.model, *robot.clock, faults, robot.made);
  FaultyDisk disk(*robot.clock, faults, robot.made);

  MissionOptions mission = mission_options_for(c);
  mission.cancelled = options.cancelled;
  mission.truth = robot.truth.get();
  RunRecorder recorder(c, options.seed, options.keep_steps);
  mission.observers = {&disk};
  mission.observers.insert(mission.observers.end(), robot.observers.begin(), robot.observers.end());
  start_records(recorder, c, options, mission);

  const DriverParts parts{.clock = *robot.clock,
                          .guard = guard,
                          .model = c.robot.model,
                          .dead_man = robot.base->dead_man(),
                          .inbox = robot.frames.get(),
                          .pose_of_wheels = goes_by_wheels(robot),
                          .ranges = range_check(*robot.frames, stop, depth),
                          .emergency_stop = robot.emergency_stop,
                          .streams = streams_of(robot, c.robot.depth_sensors().size(), limits,
                                                c.drive.inbox.max_wheel_age),
                          .requests = options.requests};
  PreflightInputs inputs;
  inputs.known.body = c.robot.slice();
  inputs.known.resolution = c.perception.mapping.resolution;
  inputs.known.floor_ahead = {
      floor_sight(c.robot.depth_sensors(), c.robot.base_height(), c.perception.mapping.slice.step),
      c.drive.ranges.front, c.planner.committed + c.drive.ranges.reaction_time};
  inputs.known.depth_camera = robot.depth.has_value();
  inputs.known.stereo_pair = has_pairs(robot);
  inputs.cancelled = mission.cancelled;
  inputs.observers = mission.observers;
  if (robot.depth) {
    inputs.floor = [&] { return floor_in(*robot.frames, depth.at(0), c.robot.base_height()); };
  }
  const SteadyClock machine;
  const double begun = robot.clock->now(), begun_by_machine = machine.now();
  beliefs.watched_by(mission.observers);
  PreflightRunOptions preflight = c.drive.preflight;
  if (options.checks_only) preflight.turn = preflight.distance = 0.0;
  const PreflightResult checked =
      run_preflight(parts, *robot.base, beliefs, preflight, c.drive.driver, inputs);
  if (options.checks_only) {
    ExplorationRunResult seen;
    seen.preflight = checked.checks;
    return seen;
  }
  Driver driver(parts, faulty_planner, checked, c.drive.driver, mission);
  const MissionResult end = drive_if_fit(driver, checked.checks, robot, beliefs, mission.cancelled);
  ExplorationRunResult result;
  result.preflight = checked.checks;
  result.driver = driver.status();
  result.health = driver.health();
  result.events = driver.events().since(0).events;
  if (robot.simulated_time) {
    if (!faults.empty()) result.faults_start = robot.made;
    result.real_time_factor = (robot.clock->now() - begun) / (machine.now() - begun_by_machine);
  }
  result.record = recorder.finish(end, robot.name, robot.truth.get(), reachable);
  result.map = beliefs.known()->octree;
  result.complaint = beliefs.complaint();
  if (robot.link_faults) {
    for (const std::string& fault : robot.link_faults()) add_reason(result.complaint, fault);
  }
  return result;
}

void start_records(RunRecorder& recorder, const Configuration& c,
                   const ExplorationRunOptions& options, MissionOptions& mission) {
  mission.observers.push_back(&recorder);
  if (!options.observers) return;
  const std::vector<RunObserver*> observers = options.observers(c);
  recorder.watched_by(observers);
  mission.observers.insert(mission.observers.end(), observers.begin(), observers.end());
}

SensorInboxOptions inbox_of(const Configuration& c) {
  SensorInboxOptions inbox = c.drive.inbox;
  inbox.pose_jump.speed = c.robot.model->max_speed();
  inbox.pose_jump.yaw_rate = c.robot.model->max_yaw_rate();
  return inbox;
}

MissionOptions mission_options_for(const Configuration& c) {
  MissionOptions options = c.mission;
  options.task = c.planner.task;
  const double coverage = c.until_coverage, area = c.until_area;
  if (coverage > 0.0 || area > 0.0) {
    options.missing = [coverage, area](const MissionStep& step) -> std::string {
      const TrueState now = step.truth.value_or(TrueState());
      if ((coverage > 0.0 && now.coverage >= coverage) || (area > 0.0 && now.seen_area >= area)) {
        return "";
      }
      return coverage > 0.0 ? formatted("%.1f of %g %% of what can be reached",
                                        100.0 * now.coverage, 100.0 * coverage)
                            : formatted("%.1f of %g m2", now.seen_area, area);
    };
  }
  return options;
}

std::unique_ptr<Replanner> planner_for(const Configuration& configuration,
                                       const ExplorationRunOptions& options) {
  if (options.make_planner) return options.make_planner(configuration);
  const SolverRegistry builtin;
  const SolverRegistry& solvers = options.solvers ? *options.solvers : builtin;
  auto planner = std::make_unique<Planner>(configuration.robot, configuration.planner,
                                           solvers.make(configuration.solver));
  planner->set_cancelled(options.cancelled);
  return planner;
}

void check_drives(const Configuration& configuration) {
  if (configuration.robot.model && configuration.robot.model->pose_layout().pz >= 0) {
    throw std::invalid_argument("robot.model is '" +
                                std::string(configuration.robot.model->name()) +
                                "', which flies; expected a model that drives, as frontiers and "
                                "the simulator are planar");
  }
  if (const std::string misfit =
          simulator_misfit(configuration.simulator, configuration.perception.mapping);
      !misfit.empty()) {
    throw std::invalid_argument(misfit);
  }
}

}  // namespace prospect
