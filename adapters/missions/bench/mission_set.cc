// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/mission_set.h"

#include <cstdio>
#include <memory>

#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/planned_problem.h"

namespace prospect {

MissionSet default_missions() {
  return {{"office", "corridor", "loop", "plan:1", "plan:2", "plan:3", "plan:4", "plan:5"}};
}

MissionSet quick_missions() { return {{"office", "loop", "plan:1"}, 1, 10, 12, 3}; }

namespace {

/// Takes the problems that are wanted of a mission.
class ProblemCapture final : public RunObserver {
 public:
  ProblemCapture(const MissionSet& missions, const std::string& world, const CaptureWatch& watch,
                 const std::function<void(const SavedProblem&)>& take, int& taken)
      : missions_(missions), world_(world), watch_(watch), take_(take), taken_(taken) {}

  void on_step(const MissionStep& step) override {
    done_ = step.index + 1;
    if (watch_.progress) {
      watch_.progress("driving in " + world_ + ": step " + std::to_string(step.index) + " of " +
                      std::to_string(last()) + ", problems so far: " + std::to_string(taken_));
    }
    const int since = step.index - missions_.first;
    if (since < 0 || since % missions_.every != 0 || step.index > last()) return;
    const auto saved = planned_problem(step, world_, missions_.seed);
    if (!saved) return;
    take_(*saved);
    ++taken_;
  }
  bool over() const { return done_ > last(); }

 private:
  int last() const { return missions_.first + (missions_.problems - 1) * missions_.every; }

  const MissionSet& missions_;
  const std::string& world_;
  const CaptureWatch& watch_;
  const std::function<void(const SavedProblem&)>& take_;
  int& taken_;
  int done_ = 0;
};

}  // namespace

bool capture_missions(const MissionSet& missions, const Configuration& configuration,
                      const Registries& registries,
                      const std::function<void(const SavedProblem&)>& take,
                      const CaptureWatch& watch) {
  const auto cancelled = [&] { return watch.cancelled && watch.cancelled(); };
  std::vector<std::shared_ptr<const World>> worlds;
  for (const std::string& name : missions.worlds) {
    worlds.push_back(mission_world(name, configuration, ConfigurationUse::kExplore));
  }
  int taken = 0;
  for (const auto& world : worlds) {
    ProblemCapture capture(missions, world->name, watch, take, taken);
    ExplorationRunOptions options;
    options.seed = missions.seed;
    options.keep_steps = false;
    options.solvers = &registries.solvers;
    options.observers = [&](const Configuration&) { return std::vector<RunObserver*>{&capture}; };
    options.cancelled = [&] { return capture.over() || cancelled(); };
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
