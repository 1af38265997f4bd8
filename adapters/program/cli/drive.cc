// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/explore.h"
#include "adapters/robots/faults/injected_fault.h"
#include "adapters/robots/user/joined_robots.h"

namespace prospect {
namespace {

struct DriveArguments {
  ExploreArguments mission;
  /// "simulator", "gazebo", "dds"; or parts of one robot, "plugin:FILE" each.
  std::vector<std::string> base = {"simulator"};
  std::string ros;                  ///< file of topics, of "dds"
  RosArgumentWords ros_arguments;   ///< above it
  std::vector<std::string> faults;  ///< injected_fault.h
  bool lockstep = false;            ///< Gazebo is stepped
  bool measure = false;             ///< Gazebo's truth measures, against mission.world
};

constexpr std::string_view kPlugin = "plugin:";

/// The robot of the plug-ins, in the place of others that there are. Their back ends are there,
/// too.
UserRobot plugin_robot(const std::vector<std::string>& bases, const Invocation& in,
                       Registries& registries) {
  registries.robots.clear();
  std::vector<UserRobot> parts;
  for (const std::string& base : bases) {
    if (!base.starts_with(kPlugin)) {
      throw InputError("--base " + base + ": given beside a plug-in; expected plug-ins alone");
    }
    const std::string file = base.substr(kPlugin.size());
    load_plugins({file}, in.load, registries);
    if (registries.robots.size() == parts.size()) {
      throw InputError("plug-in '" + file + "': has no robot; expected one for --base");
    }
    parts.push_back(registries.robots.back().robot);
  }
  UserRobot robot = joined(parts);
  registries.robots = {{bases.front().substr(kPlugin.size()), "", robot}};
  return robot;
}

int drive(const DriveArguments& arguments, const Invocation& in) {
  const bool plugin = std::ranges::any_of(
      arguments.base, [](const std::string& base) { return base.starts_with(kPlugin); });
  if (!plugin && arguments.base.size() > 1) {
    throw InputError("--base: given " + std::to_string(arguments.base.size()) +
                     " times; expected one robot");
  }
  const std::string& name = arguments.base.front();
  ExploreArguments logged = arguments.mission;
  logged.log = true;
  MissionBase base;
  const std::vector<InjectedFault> faults = parsed_faults(arguments.faults);
  if (arguments.lockstep && name != "gazebo") {
    throw InputError("--lockstep: given with --base " + name +
                     "; expected it with --base gazebo, or prospect explore");
  }
  if (arguments.lockstep && arguments.mission.check) {
    throw InputError("--lockstep: given with --check; expected a robot in real time");
  }
  if (name == "dds") {
    if (arguments.measure) {
      throw InputError("--measure: nobody knows what is true; expected it with --base gazebo");
    }
    if (arguments.ros.empty()) {
      throw InputError("--base dds: no --ros; expected the file of the robot's topics");
    }
    base.dds = read_dds_options(arguments.ros, ros_arguments(arguments.ros_arguments.remap,
                                                             arguments.ros_arguments.parameters));
    base.real_time.emplace(RealTimeRun{faults});
    return mission(logged, in.registries, base, in.signals);
  }
  if (!arguments.ros_arguments.remap.empty() || !arguments.ros_arguments.parameters.empty()) {
    throw InputError("-r, -p: given with --base " + name + "; expected --base dds");
  }
  if (!arguments.ros.empty()) {
    throw InputError("--ros: given with --base " + name + "; expected it with --base dds");
  }
  base.gazebo = name == "gazebo";
  base.measure = arguments.measure;
  base.lockstep = arguments.lockstep;
  if (arguments.lockstep && !faults.empty()) {
    throw InputError("--fault: in lockstep nothing breaks; expected it without --lockstep");
  }
  if (!arguments.lockstep) base.real_time.emplace(RealTimeRun{faults});
  if (!base.gazebo && arguments.measure) {
    throw InputError(
        plugin ? "--measure: nobody knows what is true; expected it with --base gazebo"
               : "--measure: the simulator always measures; expected it with --base gazebo");
  }
  if (plugin) {
    Registries registries = in.registries;
    const UserRobot robot = plugin_robot(arguments.base, in, registries);
    base.user = &robot;
    return mission(logged, registries, base, in.signals);
  }
  return mission(logged, in.registries, base, in.signals);
}

}  // namespace

Command drive_command(CLI::App& program) {
  const auto given = std::make_shared<DriveArguments>();
  DriveArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "drive", "The same mission in real time: threads for perception, plans and commands");
  add_world_options(command, arguments.mission);
  add_mission_options(command, arguments.mission);
  command
      ->add_option("--base", arguments.base,
                   "What is driven: the simulator as a robot with a clock, the robot of the Gazebo "
                   "that runs, one behind topics of ROS 2, or that of a shared library; of several "
                   "libraries each has a part of it [simulator]")
      ->type_name("simulator|gazebo|dds|plugin:FILE")
      ->allow_extra_args(false)
      ->check([](const std::string& base) -> std::string {
        const bool known = base == "simulator" || base == "gazebo" || base == "dds";
        const bool file = base.starts_with(kPlugin) && base.size() > kPlugin.size();
        return known || file ? ""
                             : base + " is no base; expected simulator, gazebo, dds or plugin:FILE";
      });
  command->add_option("--ros", arguments.ros, "With --base dds: the robot's topics (YAML)")
      ->type_name("FILE");
  command->add_flag("--lockstep", arguments.lockstep,
                    "With --base gazebo: its world stands while perception and planner work, and "
                    "is stepped by the mission: no machine is too slow for it");
  add_ros_arguments(command, arguments.ros_arguments);
  command->add_flag("--measure", arguments.measure,
                    "With --base gazebo: measure by Gazebo's truth, against WORLD, which it "
                    "runs; nothing else is taken from it but the start");
  add_check_option(command, arguments.mission);
  add_fault_option(command, arguments.faults);
  return {command, [given](const Invocation& in) {
            given->mission.command_line = in.typed;
            return drive(*given, in);
          }};
}

}  // namespace prospect
