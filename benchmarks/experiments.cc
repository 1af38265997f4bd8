// Missions over worlds, conditions and seeds, paired by world, seed and start, into a table; and
// what the table says.
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "adapters/config/configuration.h"
#include "adapters/files/input_error.h"
#include "adapters/run/exploration_run.h"
#include "adapters/worlds/load_world.h"
#include "benchmarks/experiments/conditions.h"
#include "benchmarks/experiments/experiment_plots.h"
#include "benchmarks/experiments/experiment_report.h"
#include "benchmarks/experiments/experiment_row.h"
#include "benchmarks/experiments/mission_start.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/mission_processes.h"
#include "benchmarks/program_options.h"
#include "benchmarks/replanners.h"

namespace prospect {
namespace {

const std::vector<std::string> kSmallWorlds = {"office", "corridor", "loop", "plan:1", "plan:2"};
const std::vector<std::string> kSmallConditions = {"with", "without"};
const std::vector<std::string> kWholeWorlds = {"office", "corridor", "loop",   "plan:1",
                                               "plan:2", "plan:3",   "plan:4", "plan:5",
                                               "plan:6", "plan:7",   "plan:8", "plan:9"};

struct Arguments {
  std::vector<std::string> worlds;
  std::vector<std::string> conditions;
  int seeds = 0;
  int first_seed = 1;
  double time_limit = 0.0;
  std::string sensors = "model";
  int jobs = 1;
  std::string out = "experiments.csv";
  std::string report, plots;
  bool small = false;
};

struct Mission {
  std::string world, condition;
  std::uint64_t seed = 0;
};

ExperimentRow labelled(ExperimentRow row, const Mission& mission, const Arguments& arguments) {
  row.world = mission.world;
  row.condition = mission.condition;
  row.seed = mission.seed;
  row.sensors = arguments.sensors;
  return row;
}

ExperimentRow failed(const std::string& why) {
  ExperimentRow row;
  row.reason = "failed: " + why;
  return row;
}

Configuration configuration_of(const Condition& condition, const Arguments& arguments) {
  Configuration configuration =
      configuration_from_text(condition.overlay, "condition " + condition.name);
  configuration.mission.time_limit = arguments.time_limit;
  configuration.simulator.sensors =
      arguments.sensors == "camera" ? Sensors::kCamera : Sensors::kModel;
  return configuration;
}

ExperimentRow run(const Mission& mission, const Arguments& arguments) {
  try {
    const Condition& how = condition(mission.condition);
    const Configuration configuration = configuration_of(how, arguments);
    World loaded = load_world(mission.world, world_options_for(configuration));
    loaded.start = mission_start(loaded.start, roomy_columns(loaded, configuration), mission.seed);
    const auto world = std::make_shared<const World>(std::move(loaded));
    std::vector<StepRecord> steps;
    ExplorationRunOptions options;
    options.seed = mission.seed;
    options.make_planner = replanner_maker(how.planner);
    options.keep_steps = false;
    options.on_step = [&](const StepRecord& step) {
      StepRecord& kept = steps.emplace_back(step);
      // Only numbers are needed: the rest is megabytes in a long mission.
      kept.horizon = {};
      kept.frontier_cells = {};
      kept.landmarks = {};
      kept.map_changes = {};
    };
    const ExplorationRunResult result = run_exploration(world, configuration, options);
    return experiment_row(result.record.summary, steps, configuration.planner.features.N_min);
  } catch (const std::exception& e) {
    return failed(e.what());
  }
}

void run_all(const std::vector<Mission>& missions, const Arguments& arguments) {
  std::size_t done = 0;
  const auto work = [&](std::size_t i) {
    append_experiment(arguments.out, labelled(run(missions[i], arguments), missions[i], arguments));
  };
  run_in_processes(missions.size(), arguments.jobs, work, [&](std::size_t i, ProcessEnd end) {
    const Mission& mission = missions[i];
    std::printf("%zu/%zu  %s, %s, seed %llu\n", ++done, missions.size(), mission.world.c_str(),
                mission.condition.c_str(), static_cast<unsigned long long>(mission.seed));
    std::fflush(stdout);
    if (end.threw) throw InputError(arguments.out + ": the row could not be written");
    if (end.signal != 0) {
      append_experiment(arguments.out, labelled(failed("signal " + std::to_string(end.signal)),
                                                mission, arguments));
    }
  });
}

void plot(const std::vector<ExperimentRow>& rows, const Arguments& arguments) {
  for (const std::string& path : write_experiment_plots(rows, arguments.plots)) {
    std::fprintf(stderr, "%s\n", path.c_str());
  }
}

int main_program(int argc, char** argv) {
  Arguments arguments;
  ProgramOptions options("Paired missions under different conditions, and what they show");
  options.add("--small", arguments.small,
              "5 worlds, 4 seeds, with and without, 150 s; options given besides count");
  options.add("--worlds", arguments.worlds,
              "worlds, as `prospect explore` takes them; default: office, corridor, loop, "
              "plan:1 to plan:9",
              {.commas = true});
  options.add("--conditions", arguments.conditions, "default: all; see conditions.cc",
              {.commas = true});
  options.add("--seeds", arguments.seeds, "how many; 0: 20, or 4 of --small",
              {.least = 0, .most = 1000});
  options.add("--first-seed", arguments.first_seed, "the first of them",
              {.least = 1, .most = 100000});
  options.add("--time-limit", arguments.time_limit,
              "of a mission, robot's clock [s]; 0: 1200, or 150 of --small",
              {.least = 0.0, .most = 1e6});
  options.add("--sensors", arguments.sensors, "model, camera", {.one_of = {"model", "camera"}});
  options.add("--jobs", arguments.jobs, "missions at a time", {.least = 1, .most = 256});
  options.add("--out", arguments.out, "table; missions it already holds are not run again");
  options.add("--report", arguments.report, "print the Markdown tables of this table and end");
  options.add("--plots", arguments.plots,
              "folder for plots of the table, drawn by gnuplot: with --report, or at the end");
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  if (!arguments.report.empty()) {
    const std::vector<ExperimentRow> rows = read_experiment(arguments.report);
    if (rows.empty()) throw InputError(arguments.report + ": no rows");
    std::cout << experiment_report(rows);
    if (!arguments.plots.empty()) plot(rows, arguments);
    return 0;
  }

  const bool small = arguments.small;
  if (arguments.worlds.empty()) arguments.worlds = small ? kSmallWorlds : kWholeWorlds;
  if (arguments.seeds == 0) arguments.seeds = small ? 4 : 20;
  if (arguments.time_limit == 0.0) arguments.time_limit = small ? 150.0 : 1200.0;
  if (arguments.conditions.empty()) {
    if (small) {
      arguments.conditions = kSmallConditions;
    } else {
      for (const Condition& c : conditions()) arguments.conditions.push_back(c.name);
    }
  }
  // What is wrong with the arguments is said before the first mission, not in each row.
  for (const std::string& name : arguments.conditions) {
    configuration_of(condition(name), arguments);
  }
  for (const std::string& world : arguments.worlds) load_world(world);

  std::set<std::tuple<std::string, std::string, std::uint64_t, std::string>> known;
  for (const ExperimentRow& row : read_experiment(arguments.out)) {
    known.emplace(row.world, row.condition, row.seed, row.sensors);
  }
  // Seeds outermost: a run that is broken off holds pairs of all worlds.
  std::vector<Mission> missions;
  const int end = arguments.first_seed + arguments.seeds;
  for (int seed = arguments.first_seed; seed < end; ++seed) {
    for (const std::string& world : arguments.worlds) {
      for (const std::string& name : arguments.conditions) {
        Mission m{world, name, static_cast<std::uint64_t>(seed)};
        if (known.emplace(m.world, m.condition, m.seed, arguments.sensors).second) {
          missions.push_back(std::move(m));
        }
      }
    }
  }
  run_all(missions, arguments);
  if (!arguments.plots.empty()) plot(read_experiment(arguments.out), arguments);
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("experiments", prospect::main_program, argc, argv);
}
