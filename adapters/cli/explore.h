#pragma once

#include <optional>

#include "adapters/cli/commands.h"
#include "adapters/run/exploration_run.h"

namespace prospect {

/// A mission in the simulator, its run folder and summary; in lockstep without `real_time`. Returns
/// the exit code.
int simulated_mission(const ExploreArguments& arguments, const Registries& registries,
                      const std::optional<RealTimeRun>& real_time);

}  // namespace prospect
