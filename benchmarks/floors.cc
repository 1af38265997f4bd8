// SPDX-License-Identifier: Apache-2.0
// floors [--seed N] [--time-limit T] [--config FILE] WORLD...: a mission on each world, and what
// became of its edges, a row of CSV each:
//   end, fallen, contacts, coverage [%], duration [s]
//   edges     cells of the map at the end whose floor it calls missing (floor_state.h)
//   false     those of them with no column of the world without floor within kNear of their centre
// The map is drawn in the estimated frame; kNear covers its drift. Of a map (.bt) instead of a
// world, as `prospect map` writes it: how many cells it knows the floor of, and how many it calls
// missing.

#include <octomap/OcTree.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/octree_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "benchmarks/program_options.h"
#include "engine/maps/floor_state.h"
#include "engine/maps/map_projection.h"

namespace prospect {
namespace {

constexpr double kNear = 0.3;  // [m]

struct Edges {
  int called = 0, wrong = 0;
};

Edges edges_of(const World& world, const octomap::OcTree& map, const OccupancyMapperOptions& o,
               const HeightSlice& slice) {
  const VoxelGrid voxels = voxels_from_octree(map, o.z_min, o.z_max);
  const FloorLayers layers = slice_layers(slice, voxels.resolution()).floor;
  const FloorLayers true_layers{floor_layer(slice.step, world.voxels.resolution()), 0};
  const auto is_near_edge = [&](const Eigen::Vector2d& p) {
    const double r = world.voxels.resolution();
    const int reach = static_cast<int>(std::ceil(kNear / r));
    const Cell at = world.voxels.frame().cell(p.x(), p.y());
    for (int dj = -reach; dj <= reach; ++dj) {
      for (int di = -reach; di <= reach; ++di) {
        const Cell c{at.i + di, at.j + dj};
        if ((world.voxels.frame().center(c) - p).norm() > kNear + 0.5 * r) continue;
        if (floor_state(world.voxels, c, true_layers) == FloorState::kMissing) return true;
      }
    }
    return false;
  };
  Edges edges;
  for (int n = 0; n < voxels.frame().size(); ++n) {
    const Cell c = voxels.frame().at(n);
    if (floor_state(voxels, c, layers) != FloorState::kMissing) continue;
    ++edges.called;
    edges.wrong += !is_near_edge(voxels.frame().center(c));
  }
  return edges;
}

void count(const std::string& file) {
  const std::unique_ptr<octomap::OcTree> map = read_octree(file, {});
  const OccupancyMapperOptions mapping;
  const VoxelGrid voxels = voxels_from_octree(*map, mapping.z_min, mapping.z_max);
  const FloorLayers layers = slice_layers(mapping.slice, voxels.resolution()).floor;
  int there = 0, missing = 0;
  for (int n = 0; n < voxels.frame().size(); ++n) {
    const FloorState floor = floor_state(voxels, voxels.frame().at(n), layers);
    there += floor == FloorState::kThere;
    missing += floor == FloorState::kMissing;
  }
  std::printf("%s: floor of %d cells is there, of %d missing\n", file.c_str(), there, missing);
}

int measure(const std::vector<std::string>& worlds, int seed, double time_limit,
            const std::string& file) {
  Configuration configuration = read_configuration(file);
  configuration.mission.time_limit = time_limit;
  std::printf("world,seed,end,fallen,contacts,coverage,reachable_m2,duration_s,edges,false\n");
  for (const std::string& name : worlds) {
    if (name.ends_with(".bt")) {
      count(name);
      continue;
    }
    const auto world =
        std::make_shared<const World>(load_world(name, world_options_for(configuration)));
    ExplorationRunOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.keep_steps = false;
    const ExplorationRunResult result = run_exploration(world, configuration, options);
    const Summary& s = result.record.summary;
    HeightSlice slice = height_slice(configuration.robot);
    slice.step = configuration.perception.mapping.slice.step;
    const Edges edges = edges_of(*world, *result.map, configuration.perception.mapping, slice);
    std::printf("%s,%d,%s,%d,%d,%.1f,%.1f,%.1f,%d,%d\n", name.c_str(), seed,
                std::string(to_string(s.end)).c_str(), s.end == MissionEnd::kFallen ? 1 : 0,
                s.collisions, 100.0 * s.coverage, s.reachable_area_m2, s.duration_s, edges.called,
                edges.wrong);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  prospect::ProgramOptions options("missions on floors with edges");
  int seed = 1;
  double time_limit = 300.0;
  std::string file;
  std::vector<std::string> worlds = {"drops:1:2x2"};
  options.add("--seed", seed, "of the missions", {.least = 0, .most = 1e9});
  options.add("--time-limit", time_limit, "[s] of each", {.least = 1.0, .most = 1e6});
  options.add("--config", file, "configuration");
  options.add("worlds", worlds, "worlds, as `prospect explore` takes them, or maps (.bt)");
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  try {
    return prospect::measure(worlds, seed, time_limit, file);
  } catch (const std::exception& e) {
    std::cerr << "floors: " << e.what() << '\n';
    return 2;
  }
}
