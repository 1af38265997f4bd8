// SPDX-License-Identifier: Apache-2.0
// What the order of the frontiers costs: the frontier planner under several configurations, each
// map from four headings, driven perfectly (exact pose, v_max or omega_max for half a second, a
// view of the depth sensor after each). Missions are chaotic and take minutes; this takes a second
// a run, so that differences of a few per cent show.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "engine/behaviour/behaviour.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/planner/frontier_planner_options.h"
#include "tests/engine/ground_worlds.h"
#include "tests/engine/simplest_driver.h"

namespace prospect {
namespace {

constexpr double kStep = 0.5;                                            // [s]
constexpr std::array<double, 5> kShares = {0.25, 0.5, 0.9, 0.95, 0.99};  // of the reachable area
constexpr std::array<double, 4> kHeadings = {0.0, 1.6, 3.1, 4.7};  // [rad] from the start pose's

struct Place {
  test::GroundWorld plan;
  std::vector<Cell> reachable;  // of the plan's lattice
  Pose start;
};

struct Run {
  std::array<std::optional<double>, kShares.size()> time;  // [s] to each share, none: not reached
  double end = 0.0;                                        // [s] when it was done, or stopped
  double path = 0.0;                                       // [m]
  int changes = 0, returns = 0;                            // of the target; those back within 20 s
  double frontier_planner = 0.0;                           // [ms] an update, mean
};

Place load(const std::string& path, const Configuration& configuration) {
  const World world = load_world(path, world_options_for(configuration));
  const Grid<std::uint8_t> free = free_columns(world.voxels, BodySlice{});
  Place place{{Grid<CellState>(free.frame, CellState::kOccupied)}, {}, world.start};
  for (std::size_t k = 0; k < free.data.size(); ++k) {
    if (free.data[k] != 0) place.plan.truth.data[k] = CellState::kFree;
  }
  const Grid<std::uint8_t> cells = reachable_area(world, configuration).cells;
  for (int k = 0; k < cells.frame.size(); ++k) {
    if (cells.data[static_cast<std::size_t>(k)] == 0) continue;
    const Eigen::Vector2d center = cells.frame.center(cells.frame.at(k));
    place.reachable.push_back(free.frame.cell(center.x(), center.y()));
  }
  return place;
}

double share_seen(const std::vector<Cell>& reachable, const GroundMap& map) {
  const auto seen = std::count_if(reachable.begin(), reachable.end(),
                                  [&](Cell c) { return map.state(c) != CellState::kUnknown; });
  return static_cast<double>(seen) / static_cast<double>(reachable.size());
}

Run drive(const Place& place, double heading, const Configuration& configuration, double longest) {
  const RobotDescription& robot = configuration.robot;
  FrontierPlanner frontier_planner(frontier_planner_options_for(robot, configuration.planner));
  const double driven = robot.model->max_speed() * kStep;
  const double turned = robot.model->max_yaw_rate() * kStep;
  Pose pose = place.start;
  pose.yaw += heading;
  const GridFrame& frame = place.plan.truth.frame;
  const Cell start = frame.cell(pose.position.x(), pose.position.y());
  GroundMap map(GridFrame{frame.resolution, start.i, start.j, 1, 1});
  Run run;
  run.end = longest;
  int updates = 0;
  std::optional<Eigen::Vector2d> last;                   // where the target was
  std::vector<std::pair<double, Eigen::Vector2d>> left;  // targets, when they were left
  for (double time = 0.0; time < longest; time += kStep) {
    place.plan.sense(pose, robot.depth.max_range, robot.depth.horizontal_fov, map);
    const auto g = frontier_planner.update(map, pose, time);
    run.frontier_planner += g->milliseconds;
    if (++updates % 4 == 0) {
      const double share = share_seen(place.reachable, map);
      for (std::size_t k = 0; k < kShares.size(); ++k) {
        if (share >= kShares[k] && !run.time[k]) run.time[k] = time;
      }
    }
    if (decide({}, {.stamp = g->stamp, .frontiers = g->facts}, {}).mode.kind == ModeKind::kDone) {
      run.end = time;
      break;
    }
    if (!g->target) continue;
    if (g->facts.changed != TargetChange::kNone) {
      ++run.changes;
      const bool back = std::any_of(left.begin(), left.end(), [&](const auto& l) {
        return time - l.first <= 20.0 && (l.second - g->target->looks_at).norm() <= 1.0;
      });
      run.returns += back;
    }
    if (last && g->facts.changed != TargetChange::kNone) left.emplace_back(time, *last);
    last = g->target->looks_at;
    run.path += test::follow(*g, pose, driven, turned);
  }
  run.frontier_planner /= updates;
  return run;
}

// Geometric mean of b / a over the pairs that have both, and its standard error.
void print_ratio(const std::vector<Run>& a, const std::vector<Run>& b, std::size_t share) {
  std::vector<double> logarithms;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k].time[share] && b[k].time[share]) {
      logarithms.push_back(std::log(*b[k].time[share] / *a[k].time[share]));
    }
  }
  const auto n = static_cast<double>(logarithms.size());
  double mean = 0.0, variance = 0.0;
  for (const double x : logarithms) mean += x / n;
  for (const double x : logarithms) variance += (x - mean) * (x - mean) / std::max(1.0, n - 1.0);
  std::printf("  %.3f +- %.3f (%d)", std::exp(mean), std::exp(mean) * std::sqrt(variance / n),
              static_cast<int>(n));
}

int main_program(int argc, char** argv) {
  std::vector<std::string> maps, configurations;
  double longest = 3000.0;  // [s] of a run
  ProgramOptions options(
      "Time to see a map by the frontier planner alone, for several configurations");
  options.add("--maps", maps, "worlds, as `prospect explore` takes them", {.required = true});
  options.add("--configs", configurations, "configuration files; the first is compared with",
              {.required = true});
  options.add("--time-limit", longest, "of a run [s]", {.least = 1e-3, .most = 1e6});
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  std::vector<Configuration> read;
  for (const std::string& file : configurations) read.push_back(read_configuration(file));
  std::vector<std::vector<Run>> runs(read.size());
  std::printf(
      "config,map,heading,t25_s,t50_s,t90_s,t95_s,t99_s,end_s,path_m,frontiers_ms,changes,"
      "returns\n");
  for (const std::string& map : maps) {
    const Place place = load(map, read.front());
    for (const double heading : kHeadings) {
      for (std::size_t c = 0; c < read.size(); ++c) {
        const Run& run = runs[c].emplace_back(drive(place, heading, read[c], longest));
        std::printf("%s,%s,%.1f", configurations[c].c_str(), map.c_str(), heading);
        for (const auto& time : run.time) time ? std::printf(",%.0f", *time) : std::printf(",");
        std::printf(",%.0f,%.1f,%.2f,%d,%d\n", run.end, run.path, run.frontier_planner, run.changes,
                    run.returns);
        std::fflush(stdout);
      }
    }
  }
  for (std::size_t c = 0; c < read.size(); ++c) {
    std::printf("%s against %s, time to 25, 50, 90, 95, 99 %%:", configurations[c].c_str(),
                configurations.front().c_str());
    for (std::size_t share = 0; share < kShares.size(); ++share) {
      print_ratio(runs.front(), runs[c], share);
    }
    std::printf("\n");
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("frontier_order", prospect::main_program, argc, argv);
}
