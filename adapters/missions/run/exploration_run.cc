// SPDX-License-Identifier: Apache-2.0
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
#include "adapters/formats/worlds/sloped_floor.h"
#include "adapters/missions/run/live_mission.h"
#include "adapters/missions/run/lockstep_mission.h"
#include "adapters/robots/simulator/make_robot.h"
#include "engine/planner/frontier_planner_options.h"
#include "engine/task/zone_map.h"
#include "models/depth_sensors.h"
#include "models/range_text.h"

namespace prospect {
namespace {

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
  options.range = longest_range(c.robot.depth.max_range, c.robot.more_depth);
  options.sensor_height = c.robot.base_height() + c.robot.depth_mount.T_BC.translation().z();
  options.map_resolution = c.perception.mapping.resolution;
  return reachable_area(world, options);
}

Grid<std::uint8_t> roomy_columns(const World& world, const Configuration& c) {
  const BodySlice slice = world_options_for(c).slice;
  Grid<std::uint8_t> standing = standing_columns(*over_the_floor(world, slice.step), slice);
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
  options.slice.step = c.perception.mapping.slice.step;
  const Task& task = c.planner.task;
  if (task.kind == TaskKind::kGoTo) options.places.emplace_back(task.goal.position.head<2>());
  if (task.area) options.places.insert(options.places.end(), task.area->begin(), task.area->end());
  return options;
}

std::shared_ptr<const World> mission_world(
    const std::string& name, const Configuration& configuration, ConfigurationUse use,
    const std::function<void(const std::string& what)>& progress) {
  WorldOptions options = world_options_for(configuration);
  options.progress = progress;
  auto world = std::make_shared<const World>(load_world(name, options));
  KeyReader reader = key_reader(configuration, use);
  reader.textured = world->mesh != nullptr;
  refuse_unread(configuration.entries, reader);
  return world;
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
  const ReachableArea reachable = told_area(reachable_area(*world, configuration), configuration);
  SimulatedRobotConfiguration simulated{
      .world = world,
      .robot = configuration.robot,
      .simulator = simulator_options_for(configuration, options.seed),
      .perception = configuration.perception,
      .reachable = reachable.cells};
  const Guard::Options limits = guard_limits_for(configuration);
  if (options.real_time) {
    simulated.base = configuration.simulated_base;
    simulated.inbox = configuration.drive.inbox;
    simulated.faults = options.real_time->faults;
    return live_mission(make_robot(simulated), configuration, limits, &reachable, options);
  }

  SimulatedLockstep robot(simulated);
  return lockstep_mission(robot, {world->name, &robot, &reachable}, configuration, limits, options);
}

}  // namespace prospect
