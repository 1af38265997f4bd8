// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/registries.h"
#include "adapters/missions/replay/recorded_run.h"
#include "adapters/missions/replay/replay.h"

namespace prospect {

/// What came of planning anew along recorded calls.
struct DriveReplay {
  Replay replay;
  int plans = 0;  ///< that were recorded and made anew
  int steps = 0;  ///< of the drive, as far as the record tells
  /// The first of them whose bits differ from the recorded ones; step -1: none.
  RunDifference difference;
  /// The first call that is not in the log, "call 40 of the planner, after step 12 at 3.2 s": the
  /// replay ends before it. "": none that is known of.
  std::string missing;
  std::vector<std::string> notes;  ///< LoggedRun::notes of the log
};

/// The recorded calls of a run in real time once more, by a planner of this configuration: of it,
/// only robot, planner and solver count. Of the replay, `steps` have the recorded ones from the
/// log, and `record` is that of the log. Open loop: nothing is driven. Throws InputError, one line:
/// no log, one without such calls, one that is damaged, one that lacks all calls that are asked
/// for; else as Planner's constructor.
DriveReplay replay_calls(const RecordedRun& run, const Configuration& configuration,
                         const Registries& registries, const ReplayOptions& options);

}  // namespace prospect
