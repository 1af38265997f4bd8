#include <cstdio>
#include <iostream>
#include <string>

#include "adapters/cli/absent_solver.h"
#include "adapters/cli/commands.h"
#include "adapters/cli/interrupt.h"
#include "adapters/cli/progress.h"
#include "adapters/config/configuration.h"
#include "adapters/dds/dds_relay.h"
#include "adapters/files/input_error.h"
#include "adapters/run/dds_run.h"

namespace prospect {
namespace {

/// What a robot behind topics cannot be told, as nobody knows its world.
void refuse_of_worlds(const DriveArguments& arguments) {
  const ExploreArguments& mission = arguments.mission;
  const auto refuse = [](bool asked, const char* option) {
    if (!asked) return;
    throw InputError(std::string(option) +
                     ": given with --base dds; expected it of a robot in a "
                     "world that is known");
  };
  refuse(!arguments.faults.empty(), "--fault");
  refuse(!mission.sensors.empty(), "--sensors");
  refuse(!mission.map.empty(), "--map");
  refuse(!mission.start.empty(), "--start");
  refuse(!mission.until.empty(), "--until");
  refuse(!mission.out.empty(), "--out");
  refuse(mission.save_problems > 0, "--save-problems");
}

void print(const DdsRunResult& result) {
  const MissionResult& mission = result.mission;
  const DriverStatus& driver = result.driver;
  std::printf("before the first motion\n%s", to_text(result.preflight).c_str());
  std::printf("%s%s%s\n", std::string(to_string(mission.end)).c_str(),
              mission.detail.empty() ? "" : ": ", mission.detail.c_str());
  std::printf("  time          %6.1f s, %d steps, %d fallbacks\n", mission.duration, mission.steps,
              mission.fallbacks);
  std::printf("  path          %6.1f m by the estimate\n", result.path);
  std::printf("in real time\n");
  std::printf("  capture to command  %s\n", driver.capture_to_command.to_text().c_str());
  std::printf("  planning step       %s\n", driver.planning.to_text().c_str());
  std::printf("  between commands    %s\n", driver.command_period.to_text().c_str());
  std::printf("  drive               %s (%s); %d late plans, %d guard stops\n",
              std::string(to_string(driver.mode.mode)).c_str(),
              std::string(to_string(driver.mode.cause)).c_str(), driver.late_plans,
              driver.guard_stops);
}

}  // namespace

int drive_dds(const DriveArguments& arguments, const Registries& registries) {
  refuse_of_worlds(arguments);
  if (arguments.ros.empty()) {
    throw InputError(
        "--ros: none is given; expected a file with the robot's topics, with --base dds");
  }
  const ExploreArguments& asked = arguments.mission;
  Configuration configuration = read_configuration(asked.configuration, registries, asked.settings);
  const DdsOptions robot = read_dds_options(arguments.ros);
  if (!asked.solver.empty()) configuration.solver = asked.solver;
  if (asked.time_limit > 0.0) configuration.mission.time_limit = asked.time_limit;
  if (tell_if_absent(configuration.solver, registries.solvers)) return kNotBuiltIn;

  Progress progress(asked.quiet);
  DdsRunOptions options;
  options.solvers = &registries.solvers;
  options.cancelled = catch_interrupts();
  options.on_step = [&](const MissionStep& step) {
    char text[160];
    std::snprintf(text, sizeof text, "%.1f s  at (%.2f, %.2f)  %s", step.time,
                  step.belief->pose.position.x(), step.belief->pose.position.y(),
                  step.plan->why.c_str());
    progress.show(text);
  };
  progress.show("waiting for the robot's topics");
  const DdsRunResult result = explore_dds(configuration, robot, options);
  progress.finish();
  print(result);
  for (const Event& event : result.events) {
    if (event.severity != Severity::kInfo) std::cerr << "prospect: " << to_text(event) << '\n';
  }
  for (const std::string& fault : result.faults) std::cerr << "prospect: " << fault << '\n';
  if (!result.complaint.empty()) std::cerr << "prospect: " << result.complaint << '\n';
  return result.mission.done() ? kDone : kFailed;
}

int relay(const std::string& ros) {
  const DdsOptions robot = read_dds_options(ros);
  DdsRelay relay(robot);
  relay.run(catch_interrupts(),
            [](const std::string& line) { std::cerr << "prospect relay: " << line << '\n'; });
  return kDone;
}

}  // namespace prospect
