#pragma once

#include <string>
#include <vector>

#include "adapters/config/configuration.h"
#include "adapters/config/registries.h"
#include "adapters/log/planner_calls.h"
#include "adapters/replay/replay.h"

namespace prospect {

/// The calls of the planner of a run in real time, from its log, in their order, up to the first
/// that is not there (the log dropped it, or ends early). Throws InputError, one line: no log, or
/// one without such calls.
std::vector<PlannerCall> read_planner_calls(const std::string& log);

/// What came of planning anew along recorded calls.
struct DriveReplay {
  Replay replay;
  int plans = 0;  ///< that were recorded and made anew
  /// The first of them whose bits differ from the recorded ones; step -1: none.
  RunDifference difference;
};

/// The recorded calls once more, by a planner of this configuration: of it, only robot, planner and
/// solver count. Of the replay, `steps` have the recorded ones from the log, and `record` is that
/// of the log. Open loop: nothing is driven. Throws InputError for a log that is damaged, and as
/// Planner's constructor.
DriveReplay replay_calls(const std::string& log, const Configuration& configuration,
                         const Registries& registries, const ReplayOptions& options);

}  // namespace prospect
