// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/missions/run/run_record.h"
#include "runtime/mission.h"
#include "runtime/mission_observer.h"

namespace prospect {

/// Who watches a mission and what is recorded of it: a run folder, a log, a live page. RunRecorder
/// tells it, on the planner's thread. As of MissionObserver, none may wait.
class RunObserver : public MissionObserver {
 public:
  /// After each planning step, what the recorder made of it. What it throws ends the mission.
  virtual void on_record(const StepRecord& /*record*/, const MissionStep& /*step*/) {}
};

}  // namespace prospect
