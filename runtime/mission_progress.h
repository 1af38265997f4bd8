#pragma once

#include <string>

#include "engine/maps/belief.h"
#include "engine/planner/replanner.h"
#include "runtime/drive_requests.h"
#include "runtime/mission.h"

namespace prospect {

/// Whether a mission is over, and how it ended: the rules of all that drive one, in lockstep or in
/// real time. Times are of the robot's clock [s]. Thread-safety: one thread. Does not throw, unless
/// MissionOptions::enough does.
class MissionProgress {
 public:
  /// options outlives it.
  MissionProgress(const MissionOptions& options, double start);

  /// Before a planning step: whether it is over because it was cancelled, time is up, or
  /// localization does not come back.
  bool over_before(const Belief& belief, double now, bool cancelled);
  /// After a planning step: counts it and says whether it is over because the task is. Where the
  /// robot is to return then, `planner` is told to, once, and it is not over yet.
  bool over_after(const MissionStep& step, Replanner& planner);

  /// Takes the place that people have asked for since the call before, if any: the planner is told
  /// to go there, and the robot to drive. At the end of that way over_after() tells it to stand and
  /// the planner to go on with the task.
  void take_detour(DriveRequests& requests, Replanner& planner);

  MissionResult result;

 private:
  bool over(MissionEnd end, const std::string& detail);

  const MissionOptions& options_;
  DriveRequests* detour_ = nullptr;  // whose way the robot is on; null: nobody's
  double start_;
  double last_localized_;
};

}  // namespace prospect
