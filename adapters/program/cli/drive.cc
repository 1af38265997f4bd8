#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/explore.h"
#include "adapters/robots/faults/injected_fault.h"

namespace prospect {
namespace {

struct DriveArguments {
  ExploreArguments mission;
  std::string base = "simulator";   ///< "simulator", "gazebo", "dds"
  std::string ros;                  ///< file of topics, of "dds"
  std::vector<std::string> faults;  ///< injected_fault.h
  bool measure = false;             ///< Gazebo's truth measures, against mission.world
};

int drive(const DriveArguments& arguments, const Invocation& in) {
  ExploreArguments logged = arguments.mission;
  logged.log = true;
  MissionBase base;
  const std::vector<InjectedFault> faults = parsed_faults(arguments.faults);
  if (arguments.base == "dds") {
    if (!faults.empty()) {
      throw InputError("--fault: nothing stands between; expected it with --base simulator|gazebo");
    }
    if (arguments.measure) {
      throw InputError("--measure: nobody knows what is true; expected it with --base gazebo");
    }
    if (arguments.ros.empty()) {
      throw InputError("--base dds: no --ros; expected the file of the robot's topics");
    }
    base.dds = read_dds_options(arguments.ros);
    return mission(logged, in.registries, base, in.signals);
  }
  if (!arguments.ros.empty()) {
    throw InputError("--ros: given with --base " + arguments.base +
                     "; expected it with --base dds");
  }
  base.gazebo = arguments.base == "gazebo";
  base.measure = arguments.measure;
  base.real_time.emplace(RealTimeRun{faults});
  if (!base.gazebo && arguments.measure) {
    throw InputError("--measure: the simulator always measures; expected it with --base gazebo");
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
  one_of(command->add_option("--base", arguments.base,
                             "What is driven: the simulator as a robot with a clock, the "
                             "robot of the Gazebo that runs, or one behind topics of ROS 2"),
         {"simulator", "gazebo", "dds"});
  command->add_option("--ros", arguments.ros, "With --base dds: the robot's topics (YAML)")
      ->type_name("FILE");
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
