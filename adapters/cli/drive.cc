#include <stdexcept>
#include <string>

#include "adapters/cli/commands.h"
#include "adapters/cli/explore.h"
#include "adapters/files/input_error.h"
#include "adapters/simulator/injected_fault.h"

namespace prospect {
namespace {

/// What is asked of the simulator's robot alone.
void refuse_of_simulator(const DriveArguments& arguments) {
  const ExploreArguments& mission = arguments.mission;
  const auto refuse = [](bool asked, const char* option) {
    if (asked) {
      throw InputError(std::string(option) +
                       ": it is of the simulator's robot; expected it with "
                       "--base simulator");
    }
  };
  refuse(!arguments.faults.empty(), "--fault");
  refuse(!mission.sensors.empty(), "--sensors");
  refuse(!mission.map.empty(), "--map");
  refuse(!mission.start.empty(), "--start");
}

}  // namespace

int drive(const DriveArguments& arguments, const Registries& registries) {
  MissionBase base;
  base.gazebo = arguments.base == "gazebo";
  base.measure = arguments.measure;
  if (base.gazebo) {
    refuse_of_simulator(arguments);
    return mission(arguments.mission, registries, base);
  }
  if (arguments.measure) {
    throw InputError("--measure: the simulator always measures; expected it with --base gazebo");
  }
  base.real_time.emplace();
  for (const std::string& text : arguments.faults) {
    try {
      base.real_time->faults.push_back(parse_fault(text));
    } catch (const std::invalid_argument& e) {
      throw InputError(std::string("--fault: ") + e.what());
    }
  }
  return mission(arguments.mission, registries, base);
}

}  // namespace prospect
