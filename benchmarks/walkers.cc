// SPDX-License-Identifier: Apache-2.0
// walkers [--count N] [--keep M] [--seeds K] [--time-limit T] [--set KEY=VALUE]... WORLD...: a
// mission on each world among N people who walk, and the same without them, a row of CSV each:
//   end, contacts (it drove into somebody or something), bumps (somebody walked into it),
//   coverage [%], duration and that without people [s]
//   trail     cells of the map at the end that are occupied at the body's heights, with nothing
//             there in the world within kNear and nobody within kBeside
// The map is drawn in the estimated frame; kNear covers its drift.

#include <octomap/OcTree.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "benchmarks/program_options.h"
#include "engine/maps/map_projection.h"
#include "runtime/mission.h"

namespace prospect {
namespace {

constexpr double kNear = 0.3, kBeside = 0.6;  // [m]

/// Keeps where people were at the last step.
class PeopleObserver final : public RunObserver {
 public:
  void on_step(const MissionStep& step) override {
    if (step.truth) last = *step.truth;
  }
  TrueState last;
};

bool solid_near(const World& world, const VerticalExtent& slice, const Eigen::Vector2d& p) {
  const VoxelGrid& voxels = world.voxels;
  const double r = voxels.resolution();
  const int reach = static_cast<int>(std::ceil(kNear / r));
  const Cell at = voxels.frame().cell(p.x(), p.y());
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      const Cell c{at.i + di, at.j + dj};
      if ((voxels.frame().center(c) - p).norm() > kNear + 0.5 * r) continue;
      const int top = static_cast<int>(std::ceil(slice.z_max / r - 1e-9));
      for (int k = static_cast<int>(std::floor(slice.z_min / r + 1e-9)); k < top; ++k) {
        if (world.solid(c.i, c.j, k)) return true;
      }
    }
  }
  return false;
}

int trail_of(const World& world, const ExplorationRunResult& result, const Configuration& c,
             const std::vector<Eigen::Vector2d>& people) {
  HeightSlice slice = height_slice(c.robot);
  slice.step = c.perception.mapping.slice.step;
  const BeliefMaps maps =
      belief_maps(result.map, slice, c.perception.mapping.z_min, c.perception.mapping.z_max);
  int cells = 0;
  for (int n = 0; n < maps.ground->frame().size(); ++n) {
    const Cell cell = maps.ground->frame().at(n);
    if (maps.ground->state(cell) != CellState::kOccupied) continue;
    const Eigen::Vector2d at = maps.ground->frame().center(cell);
    if (solid_near(world, c.robot.slice(), at)) continue;
    bool beside = false;
    for (const Eigen::Vector2d& person : people) beside |= (person - at).norm() < kBeside;
    cells += !beside;
  }
  return cells;
}

struct Arguments {
  int count = 10, seeds = 1;
  double keep = 0.5, time_limit = 300.0;
  std::string file;
  std::vector<std::string> settings, worlds;
};

int measure(const Arguments& a) {
  Configuration configuration =
      read_configuration(a.file, {}, {a.settings.begin(), a.settings.end()});
  configuration.mission.time_limit = a.time_limit;
  configuration.simulator.walkers.keep = a.keep;
  std::printf("world,seed,end,contacts,bumps,coverage,duration_s,duration_without_s,trail\n");
  for (const std::string& name : a.worlds) {
    const auto world =
        std::make_shared<const World>(load_world(name, world_options_for(configuration)));
    for (int seed = 1; seed <= a.seeds; ++seed) {
      PeopleObserver observer;
      ExplorationRunOptions options;
      options.seed = static_cast<std::uint64_t>(seed);
      options.keep_steps = false;
      configuration.simulator.walkers.count = 0;
      const Summary without = run_exploration(world, configuration, options).record.summary;
      configuration.simulator.walkers.count = a.count;
      options.observers = [&](const Configuration&) {
        return std::vector<RunObserver*>{&observer};
      };
      const ExplorationRunResult result = run_exploration(world, configuration, options);
      const Summary& s = result.record.summary;
      std::printf("%s,%d,%s,%d,%d,%.1f,%.1f,%.1f,%d\n", name.c_str(), seed,
                  std::string(to_string(s.end)).c_str(), s.collisions, observer.last.bumps,
                  100.0 * s.coverage, s.duration_s, without.duration_s,
                  trail_of(*world, result, configuration, observer.last.people));
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  prospect::ProgramOptions options("missions among people who walk");
  prospect::Arguments a;
  options.add("--count", a.count, "people", {.least = 0, .most = 1000});
  options.add("--keep", a.keep, "[m] that they keep from the robot", {.least = 0, .most = 10});
  options.add("--seeds", a.seeds, "missions on each world", {.least = 1, .most = 1000});
  options.add("--time-limit", a.time_limit, "[s] of each", {.least = 1.0, .most = 1e6});
  options.add("--config", a.file, "configuration");
  options.add("--set", a.settings, "KEY=VALUE");
  options.add("worlds", a.worlds, "as `prospect explore` takes them", {.required = true});
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  try {
    return prospect::measure(a);
  } catch (const std::exception& e) {
    std::cerr << "walkers: " << e.what() << '\n';
    return 2;
  }
}
