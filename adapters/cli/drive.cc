#include <stdexcept>

#include "adapters/cli/commands.h"
#include "adapters/cli/explore.h"
#include "adapters/files/input_error.h"
#include "adapters/simulator/injected_fault.h"

namespace prospect {

int drive(const DriveArguments& arguments, const Registries& registries) {
  if (arguments.base == "dds") return drive_dds(arguments, registries);
  if (!arguments.ros.empty()) {
    throw InputError("--ros: given with --base " + arguments.base +
                     "; expected it with --base dds");
  }
  RealTimeRun run;
  for (const std::string& text : arguments.faults) {
    try {
      run.base.faults.push_back(parse_fault(text));
    } catch (const std::invalid_argument& e) {
      throw InputError(std::string("--fault: ") + e.what());
    }
  }
  return simulated_mission(arguments.mission, registries, run);
}

}  // namespace prospect
