#include <stdexcept>
#include <string>
#include <vector>

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
  refuse(!mission.sensors.empty(), "--sensors");
  refuse(!mission.map.empty(), "--map");
  refuse(!mission.reading.start.empty(), "--start");
}

}  // namespace

int drive(const DriveArguments& arguments, const Registries& registries) {
  ExploreArguments logged = arguments.mission;
  logged.log = true;
  MissionBase base;
  std::vector<InjectedFault> faults;
  for (const std::string& text : arguments.faults) {
    try {
      faults.push_back(parse_fault(text));
    } catch (const std::invalid_argument& e) {
      throw InputError(std::string("--fault: ") + e.what());
    }
  }
  if (arguments.base == "dds") {
    refuse_of_simulator(arguments);
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
    return mission(logged, registries, base);
  }
  if (!arguments.ros.empty()) {
    throw InputError("--ros: given with --base " + arguments.base +
                     "; expected it with --base dds");
  }
  base.gazebo = arguments.base == "gazebo";
  base.measure = arguments.measure;
  base.real_time.emplace(RealTimeRun{faults});
  if (base.gazebo) {
    refuse_of_simulator(arguments);
    return mission(logged, registries, base);
  }
  if (arguments.measure) {
    throw InputError("--measure: the simulator always measures; expected it with --base gazebo");
  }
  return mission(logged, registries, base);
}

}  // namespace prospect
