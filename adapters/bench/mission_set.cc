#include "adapters/bench/mission_set.h"

#include <cstdio>
#include <memory>
#include <optional>

#include "adapters/config/configuration.h"
#include "adapters/run/exploration_run.h"
#include "adapters/worlds/load_world.h"
#include "engine/planner.h"
#include "models/version.h"

namespace prospect {

MissionSet default_missions() {
  return {{"office", "corridor", "loop", "plan:1", "plan:2", "plan:3", "plan:4", "plan:5"}};
}

MissionSet quick_missions() { return {{"office", "loop", "plan:1"}, 1, 10, 12, 3}; }

void capture_missions(const MissionSet& missions, const SolverRegistry& registry,
                      const std::function<void(const SavedProblem&)>& take) {
  const Configuration configuration = read_configuration("", registry);
  std::vector<std::shared_ptr<const World>> worlds;
  for (const std::string& name : missions.worlds) {
    worlds.push_back(
        std::make_shared<const World>(load_world(name, world_options_for(configuration))));
  }
  const int last = missions.first + (missions.problems - 1) * missions.every;
  for (const auto& world : worlds) {
    Planner* planner = nullptr;
    int done = 0;
    ExplorationRunOptions options;
    options.seed = missions.seed;
    options.keep_steps = false;
    options.make_planner = [&](const Configuration& c) {
      auto made = std::make_unique<Planner>(c.robot, c.planner, registry.make(c.solver));
      planner = made.get();
      return made;
    };
    options.on_step = [&](const StepRecord& record) {
      done = record.step + 1;
      const int since = record.step - missions.first;
      if (since < 0 || since % missions.every != 0 || record.step > last) return;
      if (!planner->recipe()) return;  // the planner had nothing to solve
      take({{std::string("prospect ") + kVersion, world->name, missions.seed, record.step,
             record.time},
            *planner->recipe(),
            planner->seeds(),
            std::nullopt});
    };
    options.cancelled = [&] { return done > last; };
    run_exploration(world, configuration, options);
  }
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
