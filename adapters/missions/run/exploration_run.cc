#include "adapters/missions/run/exploration_run.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/octree_file.h"
#include "adapters/missions/run/live_mission.h"
#include "adapters/missions/run/run_recorder.h"
#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/faults/faulty_disk.h"
#include "adapters/robots/faults/faulty_frames.h"
#include "adapters/robots/faults/faulty_replanner.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/simulated_base.h"
#include "adapters/robots/simulator/simulated_streams.h"
#include "adapters/robots/simulator/simulator.h"
#include "engine/planner/frontier_planner_options.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_guard.h"
#include "engine/task/zone_map.h"
#include "models/range_text.h"
#include "runtime/clock.h"
#include "runtime/mission.h"
#include "runtime/range_check.h"
#include "runtime/range_stop.h"
#include "runtime/seen_floor.h"
#include "runtime/sensor_inbox.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

/// The simulator as a robot: commands in, beliefs out.
class SimulatedRobot final : public Robot {
 public:
  SimulatedRobot(Simulator& simulator, std::function<void(double, const Twist&)> on_command)
      : simulator_(simulator), on_command_(std::move(on_command)) {}
  std::shared_ptr<const Belief> sense() override { return simulator_.sense(); }
  void apply(const Twist& command, double duration) override {
    if (!(duration > 0.0)) return;
    if (on_command_) on_command_(simulator_.time(), command);
    simulator_.apply(command, duration);
  }
  double time() const override { return simulator_.time(); }

 private:
  Simulator& simulator_;
  std::function<void(double, const Twist&)> on_command_;
};

/// A planner that drives, and beside it one that is asked the same.
class ReplannerPair final : public Replanner {
 public:
  ReplannerPair(Replanner& drives, Replanner* beside) : drives_(drives), beside_(beside) {}
  Plan plan(const Belief& belief) override {
    if (beside_) beside_plan_ = beside_->plan(belief);
    return drives_.plan(belief);
  }
  std::shared_ptr<const GlobalPlan> global_plan() const override { return drives_.global_plan(); }
  std::optional<ReturnPath> return_path(const Belief& belief) const override {
    return drives_.return_path(belief);
  }
  std::string set_task(const Task& task) override {
    if (beside_) beside_->set_task(task);
    return drives_.set_task(task);
  }
  const Plan& beside_plan() const { return beside_plan_; }

 private:
  Replanner& drives_;
  Replanner* beside_;
  Plan beside_plan_;
};

/// The depth camera of the tier: that of the images, or one for the rays of a scan. None: what it
/// sees is no image in perspective.
std::optional<RangeCamera> range_camera(const Configuration& configuration) {
  const RgbdFootprint& seen = configuration.robot.depth;
  if (std::max(seen.horizontal_fov, seen.vertical_fov) >= M_PI) return std::nullopt;
  const SimulatorOptions& simulator = configuration.simulator;
  const CameraRigOptions& rig = simulator.camera.rig;
  const bool images = simulator.sensors == Sensors::kCamera;
  // Rays of a scan lie between pixels, by less in a finer image.
  constexpr int kFiner = 4;
  RangeCamera camera;
  camera.camera = depth_camera(seen, images ? rig.depth_width : kFiner * simulator.depth.columns,
                               images ? rig.depth_height : kFiner * simulator.depth.rows);
  camera.mount = configuration.robot.depth_mount;
  camera.range = {seen.min_range, seen.max_range};
  return camera;
}

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

std::shared_ptr<const octomap::OcTree> map_to_begin_with(const Configuration& configuration) {
  std::shared_ptr<const octomap::OcTree> map = read_octree(configuration.map);
  const double resolution = configuration.perception.mapping.resolution;
  if (map->getResolution() != resolution) {
    throw InputError(configuration.map + ": resolution is " + exact_text(map->getResolution()) +
                     " m; expected " + exact_text(resolution) +
                     " m, perception.mapping.resolution");
  }
  return map;
}

}  // namespace

ReachableArea reachable_area(const World& world, const Configuration& c) {
  ReachableAreaOptions options;
  options.slice = world_options_for(c).slice;
  const TraversabilityOptions passable =
      frontier_planner_options_for(c.robot, c.planner).traversability;
  options.room =
      passable.hard_radius - circumscribed_radius(c.robot.shape) - passable.lattice_slack;
  options.free_moves = passable.free_moves;
  options.zones = passable.zones;
  options.range = c.robot.depth.max_range;
  options.sensor_height = c.robot.base_height() + c.robot.depth_mount.T_BC.translation().z();
  options.map_resolution = c.perception.mapping.resolution;
  return reachable_area(world, options);
}

Grid<std::uint8_t> roomy_columns(const World& world, const Configuration& c) {
  const BodySlice slice = world_options_for(c).slice;
  Grid<std::uint8_t> standing = standing_columns(world.voxels, slice);
  const ZoneMap zones(c.planner.zones);
  for (int n = 0; zones.num_forbidden() > 0 && n < standing.frame.size(); ++n) {
    const Eigen::Vector2d center = standing.frame.center(standing.frame.at(n));
    if (zones.distance(center) < slice.standing_clearance) {
      standing.data[static_cast<std::size_t>(n)] = 0;
    }
  }
  const Eigen::Vector3d& start = world.start.position;
  return connected_component(standing, standing.frame.cell(start.x(), start.y()));
}

void check_start(const World& world, const Configuration& c) {
  const ZoneMap zones(c.planner.zones);
  const BodyOutline body = body_outline(c.robot.shape);
  for (int part = 0; part < zones.num_forbidden(); ++part) {
    if (zones.gap(part, body, world.start) >= 0.0) continue;
    throw InputError(zones.name(part) + ": the robot at the start (" +
                     exact_text(world.start.position.x()) + ", " +
                     exact_text(world.start.position.y()) + ") is " +
                     (part == 0 && zones.zones().bound ? "beyond it" : "in it") +
                     "; expected a start that keeps to the zones");
  }
}

void tell_extent(const World& world, Configuration& c) {
  const GridFrame& frame = world.voxels.frame();
  const double r = frame.resolution;
  c.planner.frontier_planner.traversability.extent =
      Eigen::AlignedBox2d(r * Eigen::Vector2d(frame.i0, frame.j0),
                          r * Eigen::Vector2d(frame.i0 + frame.width, frame.j0 + frame.height));
}

ReachableArea told_area(ReachableArea reachable, const Configuration& c) {
  const std::optional<Polygon>& area = c.planner.task.area;
  if (!area && c.planner.zones.empty()) return reachable;
  const ZoneMap zones(c.planner.zones);
  const GridFrame& frame = reachable.cells.frame;
  int kept = 0;
  for (int n = 0; n < frame.size(); ++n) {
    std::uint8_t& cell = reachable.cells.data[static_cast<std::size_t>(n)];
    const Eigen::Vector2d center = frame.center(frame.at(n));
    if ((area && !contains(*area, center)) || zones.distance(center) <= 0.0) cell = 0;
    kept += cell != 0;
  }
  reachable.area = kept * frame.resolution * frame.resolution;
  return reachable;
}

WorldOptions world_options_for(const Configuration& c) {
  const VerticalExtent slice = c.robot.slice();
  WorldOptions options = c.world;
  options.slice.z_min = slice.z_min;
  options.slice.z_max = slice.z_max;
  options.slice.standing_clearance =
      circumscribed_radius(c.robot.shape) + c.perception.mapping.resolution;
  options.slice.shape = c.robot.shape;
  const Task& task = c.planner.task;
  if (task.kind == TaskKind::kGoTo) options.places.emplace_back(task.goal.position.head<2>());
  if (task.area) options.places.insert(options.places.end(), task.area->begin(), task.area->end());
  return options;
}

SimulatorOptions simulator_options_for(const Configuration& configuration, std::uint64_t seed) {
  SimulatorOptions options = configuration.simulator;
  options.seed = seed;
  if (!configuration.map.empty()) options.map = map_to_begin_with(configuration);
  return options;
}

Guard::Options guard_limits_for(const Configuration& configuration) {
  Guard::Options limits = configuration.guard;
  const SimulatorOptions& simulator = configuration.simulator;
  const auto at_least = [](double& limit, double rate) { limit = std::max(limit, 2.0 / rate); };
  at_least(limits.max_map_age, simulator.depth_rate);
  at_least(limits.max_ranges_age, simulator.depth_rate);
  at_least(limits.max_pose_age, simulator.image_rate);
  at_least(limits.max_landmarks_age, simulator.image_rate);
  return limits;
}

ExplorationRunResult run_exploration(const std::shared_ptr<const World>& world,
                                     const Configuration& given,
                                     const ExplorationRunOptions& options) {
  check_drives(given);
  check_start(*world, given);
  Configuration configuration = given;
  tell_extent(*world, configuration);
  const std::unique_ptr<Replanner> planner = planner_for(configuration, options);
  const Planner* own_planner = dynamic_cast<const Planner*>(planner.get());
  const ReachableArea reachable = told_area(reachable_area(*world, configuration), configuration);

  Simulator simulator(world, simulator_options_for(configuration, options.seed),
                      configuration.perception);
  simulator.set_reachable(reachable.cells);
  SimulatedRobot robot(simulator, options.taps.command);

  const Guard::Options limits = guard_limits_for(configuration);
  const Guard guard = guard_for(configuration.robot, configuration.planner, limits);

  ReplannerPair pair(*planner, options.real_time ? nullptr : options.beside);
  ExplorationRunResult result;
  RunRecorder recorder(configuration, options, own_planner);
  const SteadyClock clock;
  std::optional<SimulatedBase> base;  // in real time
  std::optional<FaultyDisk> disk;     // likewise
  const auto truth = [&] { return base ? base->truth() : truth_of(simulator); };
  const auto observe = [&](const MissionStep& step) {
    if (options.taps.belief && !base) options.taps.belief(*step.belief);
    if (disk) disk->write();
    if (options.beside && options.on_beside) {
      MissionStep beside = step;
      const std::shared_ptr<const GlobalPlan> global_plan = options.beside->global_plan();
      beside.plan = &pair.beside_plan();
      beside.global_plan = global_plan.get();
      options.on_beside(beside, truth());
    }
    recorder.add(step, truth());
  };
  if (options.on_start) options.on_start(configuration);
  const MissionOptions mission_options = mission_options_for(configuration, truth);
  MissionResult mission;
  if (options.real_time) {
    const std::vector<InjectedFault>& faults = options.real_time->faults;
    base.emplace(simulator, clock, *configuration.robot.model, configuration.simulated_base);
    FaultyBase faulty_base(*base, clock, faults, base->start());
    SensorInbox inbox(
        clock, FaultyFrames::inbox_options(simulated_inbox(configuration.drive.inbox), faults));
    const RgbdFootprint& seen = configuration.robot.depth;
    FaultyFrames frames(clock, inbox, faults, base->start(), {seen.min_range, seen.max_range});
    SimulatedStreams streams(*base, simulator, clock, inbox, frames_into(frames),
                             configuration.simulated_base.belief_period, options.taps.sensors);
    const std::optional<RangeCamera> camera = range_camera(configuration);
    const RangeStop range_stop(configuration.drive.ranges);
    FaultyReplanner replanner(*planner, *configuration.robot.model, clock, faults, base->start());
    disk.emplace(clock, faults, base->start());
    // Without one there are no images, and its numbers are not looked at.
    const RangeCamera looking = camera.value_or(RangeCamera{});
    const double base_height = configuration.robot.base_height();
    const auto floor = [&]() -> std::optional<PreflightFacts::Floor> {
      const NewestRanges newest = inbox.ranges();
      if (!camera || (!newest.depth.image && !newest.scan.in_B)) return std::nullopt;
      return seen_floor(
          newest.depth.image ? *newest.depth.image : depth_image(*newest.scan.in_B, *camera),
          camera->camera, camera->mount, base_height, camera->range);
    };
    const auto stamp = [](double SourceStamps::*of) {
      return [of](const Belief* newest) {
        return newest ? std::optional(newest->stamps.*of) : std::nullopt;
      };
    };
    LiveRobot live{.clock = clock,
                   .base = faulty_base,
                   .beliefs = streams,
                   .planner = replanner,
                   .guard = guard,
                   .inbox = &inbox,
                   .streams = {{"cameras", limits.max_pose_age, stamp(&SourceStamps::pose)},
                               {"depth", limits.max_ranges_age, stamp(&SourceStamps::ranges)}},
                   .ranges = range_check(inbox, range_stop, looking),
                   .floor = floor};
    mission = live_mission(live, configuration, mission_options, observe, options, result);
  } else {
    simulator.set_tap(options.taps.sensors);
    mission = run_mission(robot, pair, guard, mission_options, observe, options.cancelled,
                          options.requests);
  }
  SimulatedTruth at_end = truth_of(simulator);
  result.record = recorder.finish(mission, world->name, at_end, &reachable);
  result.map = simulator.sense()->octree;
  result.complaint = simulator.complaint();
  return result;
}

}  // namespace prospect
