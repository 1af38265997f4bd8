#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include "adapters/cli/absent_solver.h"
#include "adapters/cli/commands.h"
#include "adapters/cli/interrupt.h"
#include "adapters/config/configuration.h"
#include "adapters/config/input_error.h"
#include "adapters/report/progress_line.h"
#include "adapters/run/csv.h"
#include "adapters/run/exploration_run.h"
#include "adapters/run/planned_problem.h"
#include "adapters/run/run_folder.h"
#include "adapters/worlds/load_world.h"

namespace prospect {
namespace {

/// "nlopt:LD_SLSQP" -> "nlopt-LD_SLSQP": fit for a folder's name.
std::string file_name(std::string text) {
  for (char& c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       c == '_' || c == '.' || c == '-';
    if (!plain) c = '-';
  }
  return text;
}

/// With that many decimals; "-" where there is no number.
std::string decimals(double value, int places) {
  if (!std::isfinite(value)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", places, value);
  return text;
}
std::string tenths(double value) { return decimals(value, 1); }

void print_summary(const Summary& s) {
  std::printf("%s, seed %llu, %s: %s\n", s.world.c_str(), static_cast<unsigned long long>(s.seed),
              s.solver.c_str(), s.reason.c_str());
  std::printf("  coverage      %6s %% of %.1f m2 reachable\n", tenths(100.0 * s.coverage).c_str(),
              s.reachable_area_m2);
  if (s.too_long_for_m2 > 0.0) {
    std::printf("  left out      %6.1f m2 that its length keeps the robot from\n",
                s.too_long_for_m2);
  }
  std::printf("  time          %6.1f s; to 90 / 95 / 99 %%: %s / %s / %s s\n", s.duration_s,
              tenths(s.time_to_90_s).c_str(), tenths(s.time_to_95_s).c_str(),
              tenths(s.time_to_99_s).c_str());
  std::printf("  path          %6.1f m\n", s.path_length_m);
  std::printf("  collisions    %6d    losses of localization %d\n", s.collisions, s.losses);
  std::printf("  localization  %6s m final, %s m RMS, %s %% of the path\n",
              decimals(s.localization_final_m, 3).c_str(),
              decimals(s.localization_rmse_m, 3).c_str(), decimals(s.drift_percent, 2).c_str());
  std::printf("  planning      %6s ms p50, %s p95, %s max; %d steps, %d fallbacks\n",
              tenths(s.plan_ms_p50).c_str(), tenths(s.plan_ms_p95).c_str(),
              tenths(s.plan_ms_max).c_str(), s.steps, s.fallbacks);
  std::printf("  wall clock    %6.1f s, %s times faster than real time\n", s.wall_s,
              tenths(s.duration_s / s.wall_s).c_str());
}

}  // namespace

int explore(const ExploreArguments& arguments, const SolverRegistry& registry) {
  Configuration configuration = read_configuration(arguments.configuration, registry);
  if (!arguments.solver.empty()) {
    configuration.solver = arguments.solver;
    const std::string wrong = solver_problem(configuration.solver, registry);
    if (!wrong.empty()) throw InputError("--solver: " + wrong);
    override_entry(configuration, "planner.solver", arguments.solver);
  }
  if (arguments.time_limit > 0.0) {
    configuration.mission.time_limit = arguments.time_limit;
    override_entry(configuration, "mission.time_limit", csv::text(arguments.time_limit));
  }
  if (!arguments.sensors.empty()) {
    configuration.simulator.sensors = sensors_named(arguments.sensors);
    override_entry(configuration, "simulator.sensors", arguments.sensors);
  }
  if (tell_if_absent(configuration.solver, registry)) return kNotBuiltIn;
  WorldOptions world_options = world_options_for(configuration);
  if (!arguments.start.empty()) {
    world_options.start =
        Pose{{arguments.start[0], arguments.start[1], 0.0}, arguments.start[2] * M_PI / 180.0};
  }
  const auto world = std::make_shared<const World>(load_world(arguments.world, world_options));

  ExplorationRunOptions options;
  options.seed = arguments.seed;
  options.solvers = &registry;

  const std::string out = arguments.out.empty() ? "runs/" + file_name(world->name) + "_" +
                                                      file_name(configuration.solver) + "_" +
                                                      std::to_string(arguments.seed)
                                                : arguments.out;
  std::optional<RunFolder> folder;
  options.on_start = [&] { folder.emplace(out); };  // not before: nothing is written for a refusal
  options.cancelled = catch_interrupts();
  ProgressLine progress = ProgressLine::on_stderr();
  const auto start = std::chrono::steady_clock::now();
  options.on_step = [&](const StepRecord& step) {
    folder->add(step);
    if (arguments.quiet) return;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    progress.show(step, configuration.solver, elapsed.count());
  };
  if (arguments.save_problems > 0) {
    options.on_plan = [&](const StepRecord& step, const Planner& planner) {
      if (step.step % arguments.save_problems != 0) return;
      const auto saved = planned_problem(planner, step, world->name, arguments.seed);
      if (saved) folder->add(*saved);
    };
  }
  const ExplorationRunResult result = run_exploration(world, configuration, options);
  progress.finish();
  folder->finish(result.record, result.map.get());
  if (!folder->error().empty()) std::cerr << "prospect: " << folder->error() << '\n';

  if (!result.complaint.empty()) std::cerr << "prospect: sensors: " << result.complaint << '\n';

  const Summary& summary = result.record.summary;
  if (arguments.json) {
    std::cout << summary_json(summary);
  } else {
    print_summary(summary);
    std::printf("  report        %s/report.html\n", folder->path().c_str());
  }
  const bool lost = summary.reason == to_string(MissionEnd::kLost);
  const bool unreachable = summary.reason == to_string(MissionEnd::kUnreachable);
  const bool cancelled = summary.reason == to_string(MissionEnd::kCancelled);
  return lost || unreachable || cancelled || summary.collisions > 0 || !folder->error().empty()
             ? kFailed
             : kDone;
}

}  // namespace prospect
