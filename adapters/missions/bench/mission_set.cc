#include "adapters/missions/bench/mission_set.h"

#include <cstdio>
#include <memory>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/planned_problem.h"

namespace prospect {

MissionSet default_missions() {
  return {{"office", "corridor", "loop", "plan:1", "plan:2", "plan:3", "plan:4", "plan:5"}};
}

MissionSet quick_missions() { return {{"office", "loop", "plan:1"}, 1, 10, 12, 3}; }

bool capture_missions(const MissionSet& missions, const Configuration& configuration,
                      const Registries& registries,
                      const std::function<void(const SavedProblem&)>& take,
                      const CaptureWatch& watch) {
  const auto cancelled = [&] { return watch.cancelled && watch.cancelled(); };
  std::vector<std::shared_ptr<const World>> worlds;
  for (const std::string& name : missions.worlds) {
    worlds.push_back(
        std::make_shared<const World>(load_world(name, world_options_for(configuration))));
  }
  const int last = missions.first + (missions.problems - 1) * missions.every;
  int taken = 0;
  for (const auto& world : worlds) {
    int done = 0;
    ExplorationRunOptions options;
    options.seed = missions.seed;
    options.keep_steps = false;
    options.solvers = &registries.solvers;
    options.on_plan = [&](const StepRecord& record, const Planner& planner) {
      done = record.step + 1;
      if (watch.progress) {
        watch.progress("driving in " + world->name + ": step " + std::to_string(record.step) +
                       " of " + std::to_string(last) +
                       ", problems so far: " + std::to_string(taken));
      }
      const int since = record.step - missions.first;
      if (since < 0 || since % missions.every != 0 || record.step > last) return;
      const auto saved = planned_problem(planner, record, world->name, missions.seed);
      if (!saved) return;
      take(*saved);
      ++taken;
    };
    options.cancelled = [&] { return done > last || cancelled(); };
    run_exploration(world, configuration, options);
    if (cancelled()) return false;
  }
  return true;
}

std::string problem_file_name(const ProblemOrigin& origin) {
  std::string name = origin.world;
  for (char& c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    if (!plain) c = '-';
  }
  char step[16];
  std::snprintf(step, sizeof step, "_%06d.h5", origin.step);
  return name + step;
}

}  // namespace prospect
