// SPDX-License-Identifier: Apache-2.0
// Missions of several planners over maps and seeds, one process each, into a table.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/builtin_worlds.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "benchmarks/comparison_table.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/mission_processes.h"
#include "benchmarks/program_options.h"
#include "benchmarks/replanners.h"
#include "runtime/mission.h"

namespace prospect {
namespace {

/// Maps of the default comparison, below the data folder: those of 50 to 600 m2 reachable, of
/// different kinds. Their resolution is that of their .yaml, else 0.05 m a pixel.
const std::vector<std::string> kMaps = {
    "movingai/Berlin_0_256.map",
    "ipa_room_segmentation/freiburg_building101.png",
    "aws_bookstore/map.yaml",
    "stage/simple_rooms.png",
    "aws_warehouse/map.pgm",
    "ipa_room_segmentation/Freiburg79_scan.png",
    "ipa_room_segmentation/lab_c_scan.png",
    "ipa_room_segmentation/intel_map.png",
    "nav2_depot/depot.yaml",
    "stage/cave.png",
    "ipa_room_segmentation/lab_d_scan_furnitures.png",
};

struct Arguments {
  std::vector<std::string> maps;
  std::string data = "../shared/data/maps2d";
  int seeds = 3;
  std::vector<std::string> planners = replanner_names();
  int jobs = 1;
  std::string out = "exploration_comparison.csv";
  double time_limit = 1800.0;
  double until = 1.0;
  std::string configuration;
  std::string report;
  std::string paths;
  bool list = false;
};

struct Mission {
  std::string path, map, planner;
  std::uint64_t seed = 0;
};

std::string label(const std::string& path) {
  const std::filesystem::path p(path);
  const std::string stem = p.stem().string();
  return stem == "map" && p.has_parent_path() ? p.parent_path().filename().string() : stem;
}

std::vector<std::string> maps_of(const Arguments& arguments) {
  if (!arguments.maps.empty()) return arguments.maps;
  std::vector<std::string> maps = builtin_world_names();
  for (const std::string& map : kMaps) maps.push_back(arguments.data + "/" + map);
  return maps;
}

ComparisonRow failed(const Mission& mission, const std::string& why) {
  ComparisonRow row;
  row.map = mission.map;
  row.planner = mission.planner;
  row.seed = mission.seed;
  row.reason = "failed: " + why;
  return row;
}

/// Writes each step as a row, and says when enough was seen.
struct PathRow final : RunObserver {
  PathRow(std::FILE* its_path, double its_until) : path(its_path), until(its_until) {}
  void on_record(const StepRecord& s, const MissionStep&) override {
    enough = s.coverage >= until;
    if (path == nullptr) return;
    std::fprintf(path, "%.3f,%.3f,%.3f,%.3f,%.5f,%s\n", s.time, s.true_pose.position.x(),
                 s.true_pose.position.y(), s.true_pose.yaw, s.coverage, s.seed.c_str());
  }
  std::FILE* path;
  double until;
  bool enough = false;
};

ComparisonRow run(const Mission& mission, const Arguments& arguments) {
  try {
    Configuration configuration = read_configuration(arguments.configuration);
    configuration.mission.time_limit = arguments.time_limit;
    const auto world =
        std::make_shared<const World>(load_world(mission.path, world_options_for(configuration)));
    ExplorationRunOptions options;
    options.seed = mission.seed;
    options.make_planner = replanner_maker(mission.planner);
    std::FILE* path = nullptr;
    if (!arguments.paths.empty()) {
      const std::string name = arguments.paths + "/" + mission.map + "_" + mission.planner + "_" +
                               std::to_string(mission.seed) + ".csv";
      path = std::fopen(name.c_str(), "w");
      if (path == nullptr) throw InputError(name + ": cannot be opened for writing");
      std::fputs("time,x,y,yaw,coverage,plan\n", path);
    }
    PathRow row(path, arguments.until);
    options.observers = [&](const Configuration&) { return std::vector<RunObserver*>{&row}; };
    if (arguments.until < 1.0) options.cancelled = [&] { return row.enough; };
    options.keep_steps = false;
    ExplorationRunResult result = run_exploration(world, configuration, options);
    // Nothing else cancels a mission: one that ends by itself keeps its reason.
    MissionEnd& end = result.record.summary.end;
    if (end == MissionEnd::kCancelled) end = MissionEnd::kEnough;
    if (path != nullptr) std::fclose(path);
    return comparison_row(mission.map, mission.planner, result.record.summary);
  } catch (const std::exception& e) {
    return failed(mission, e.what());
  }
}

void list_maps(const Arguments& arguments) {
  const Configuration configuration = read_configuration(arguments.configuration);
  for (const std::string& path : maps_of(arguments)) {
    try {
      const World world = load_world(path, world_options_for(configuration));
      std::printf("%7.1f m2  %s\n", reachable_area(world, configuration).area, path.c_str());
    } catch (const std::exception& e) {
      std::printf("          -  %s\n", e.what());
    }
    std::fflush(stdout);
  }
}

void run_all(const std::vector<Mission>& missions, const Arguments& arguments) {
  std::size_t done = 0;
  const auto work = [&](std::size_t i) {
    append_comparison(arguments.out, run(missions[i], arguments));
  };
  run_in_processes(missions.size(), arguments.jobs, work, [&](std::size_t i, ProcessEnd end) {
    const Mission& mission = missions[i];
    std::printf("%zu/%zu  %s, %s, seed %llu\n", ++done, missions.size(), mission.map.c_str(),
                mission.planner.c_str(), static_cast<unsigned long long>(mission.seed));
    std::fflush(stdout);
    if (end.threw) throw InputError(arguments.out + ": the row could not be written");
    if (end.signal != 0) {
      append_comparison(arguments.out, failed(mission, "signal " + std::to_string(end.signal)));
    }
  });
}

int main_program(int argc, char** argv) {
  Arguments arguments;
  ProgramOptions options(
      "Exploration missions of several planners over maps and seeds, and their comparison");
  options.add("--maps", arguments.maps, "worlds, as `prospect explore` takes them");
  options.add("--data", arguments.data, "folder of the default maps");
  options.add("--seeds", arguments.seeds, "seeds 1 to this", {.least = 1, .most = 1000});
  options.add("--planners", arguments.planners, "planners that are compared",
              {.one_of = replanner_names(), .commas = true});
  options.add("--jobs", arguments.jobs, "missions at a time", {.least = 1, .most = 256});
  options.add("--out", arguments.out, "table; missions it already holds are not run again");
  options.add("--until", arguments.until, "share of the reachable area at which a mission is ended",
              {.least = 0.01, .most = 1.0});
  options.add("--time-limit", arguments.time_limit, "of a mission, robot's clock [s]",
              {.least = 1e-3, .most = 1e6});
  options.add("--config", arguments.configuration, "configuration file of all missions");
  options.add("--paths", arguments.paths, "existing folder for the path of each mission");
  options.add("--report", arguments.report, "print the Markdown tables of this table and end");
  options.add("--list", arguments.list, "print the reachable area of each map and end");
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  if (!arguments.report.empty()) {
    const std::vector<ComparisonRow> rows = read_comparison(arguments.report);
    if (rows.empty()) throw InputError(arguments.report + ": no rows");
    std::cout << comparison_report(rows);
    return 0;
  }
  if (arguments.list) {
    list_maps(arguments);
    return 0;
  }

  std::map<std::string, std::string> path_of;
  for (const std::string& path : maps_of(arguments)) {
    const auto [it, fresh] = path_of.emplace(label(path), path);
    if (!fresh && it->second != path) {
      throw InputError("two maps are called " + it->first + ": " + it->second + " and " + path);
    }
  }
  std::set<std::tuple<std::string, std::string, std::uint64_t>> known;
  for (const ComparisonRow& row : read_comparison(arguments.out)) {
    known.emplace(row.map, row.planner, row.seed);
  }
  // Seeds outermost: a run that is broken off has compared all maps.
  std::vector<Mission> missions;
  for (int seed = 1; seed <= arguments.seeds; ++seed) {
    for (const std::string& path : maps_of(arguments)) {
      for (const std::string& planner : arguments.planners) {
        Mission m{path, label(path), planner, static_cast<std::uint64_t>(seed)};
        if (known.emplace(m.map, m.planner, m.seed).second) missions.push_back(std::move(m));
      }
    }
  }
  run_all(missions, arguments);
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("exploration_comparison", prospect::main_program, argc, argv);
}
