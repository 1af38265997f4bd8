// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/robot/run_robot.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "adapters/formats/files/exit_code.h"
#include "adapters/program/cli/build_info.h"
#include "adapters/program/cli/command_line.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/explore.h"
#include "adapters/program/cli/parse_command_line.h"
#include "adapters/program/cli/printable_output.h"
#include "adapters/robots/user/joined_robots.h"

namespace prospect {
namespace {

int run(int argc, char** argv, const UserRobot& robot, SignalGuard& signals) {
  check(robot);
  CLI::App app{"A mission on the robot '" + robot.name + "'.", robot.name};
  ExploreArguments arguments;
  std::vector<std::string> faults, plugins;
  bool version = false;
  app.add_flag("--version", version, "The version of Prospect, and exit");
  add_mission_options(&app, arguments);
  add_check_option(&app, arguments);
  add_fault_option(&app, faults);
  add_plugins(&app, plugins);
  try {
    parse_command_line(app, argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  }
  if (version) {
    std::cout << to_text(build_info());
    return kDone;
  }
  Registries registries;
  load_plugins(
      plugins,
      [](const std::string& path, const PluginTargets& to) { return load_plugin(path, to); },
      registries);
  registries.robots = {{"", "", robot}};
  arguments.log = true;
  arguments.command_line = typed_line(argc, argv);
  MissionBase base;
  base.user = &robot;
  base.real_time.emplace(RealTimeRun{parsed_faults(faults)});
  return mission(arguments, registries, base, signals);
}

}  // namespace

int run_robot(int argc, char** argv, const UserRobot& robot) {
  const PrintableOutput printable;
  return reported([&](SignalGuard& signals) { return run(argc, argv, robot, signals); });
}

}  // namespace prospect
