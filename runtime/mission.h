// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/planner/planning_step.h"
#include "engine/planner/replanner.h"
#include "engine/safety/guard.h"
#include "engine/task/task.h"
#include "runtime/drive_requests.h"
#include "runtime/lockstep_robot.h"
#include "runtime/mission_end.h"
#include "runtime/mission_observer.h"
#include "runtime/truth.h"

namespace prospect {

class Knobs;

struct MissionStep;

struct MissionOptions {
  double time_limit = 1200.0;  ///< [s] of the robot's clock
  double lost_limit = 120.0;   ///< [s] without localization that end the mission
  /// Asked after each planning step, once observers were told: what is missing to what is to be
  /// seen, such as "18.0 of 60.0 m2 were seen"; "" ends the task: enough was seen. Empty: no such
  /// thing is asked for. An exploration that ends with something missing has not done its task.
  std::function<std::string(const MissionStep&)> missing{};
  /// Once the task is over (not: lost, cancelled), back to where the mission began. The path back
  /// begins in time for it to fit into time_limit (Replanner::return_path()).
  bool return_when_done = false;
  /// That the planner was given: what it goes on with after a detour.
  Task task{};
  std::vector<MissionObserver*> observers{};  ///< they outlive the mission
  /// Asked before each planning step, in real time again and again, on the thread that drives the
  /// mission; true ends it. Empty: nobody cancels.
  std::function<bool()> cancelled{};
  Truth* truth = nullptr;  ///< for MissionStep::truth; null: nobody knows
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, MissionOptions& options);

/// What an observer is shown after each planning step, before it is executed.
struct MissionStep {
  int index = 0;
  double time = 0.0;  ///< [s]
  const Belief* belief = nullptr;
  const Plan* plan = nullptr;
  const GlobalPlan* global_plan = nullptr;
  /// Commands of the previous plan that the guard turned into stops, since the last step.
  int guard_stops = 0;
  GuardReason guard_reason = GuardReason::kPassed;  ///< of the last of them
  /// What the planner made besides, never changed again; null: it does not tell.
  std::shared_ptr<const PlanningStep> made{};
  std::optional<TrueState> truth{};  ///< none: nobody knows
};

struct MissionResult {
  MissionEnd end = MissionEnd::kTimeLimit;
  std::string detail;
  double duration = 0.0;  ///< [s] of the robot's clock
  int steps = 0;
  int fallbacks = 0;    ///< steps that ended in a stopping tail
  int guard_stops = 0;  ///< commands that the guard replaced
  /// Of return_when_done, once the task was over: whether the robot is back. Then `end` says how
  /// the task ended, and `detail` also why it did not get back.
  std::optional<bool> back;
  std::optional<double> turned_back_at;  ///< [s] since the start, of the path back for want of time
  /// [rad] that is left to the heading that was asked for, of a goal whose heading cannot be had.
  std::optional<double> heading_missed;
  /// The task was done, and the robot is back if it was told to return.
  bool done() const { return row_of(end).outcome == Outcome::kDone && back.value_or(true); }
};

/// Does the planner's task until the plan's mode is done or time is up:
///   sense -> plan -> for each committed stage: sense, guard, apply.
/// Every command passes the guard with the newest belief, the last ones too: the mission ends by
/// braking as hard as is admissible until the robot stands, which result.duration does not count
/// (at most 100 commands; then a base that cannot stop is left as it is). A plan that was cancelled
/// while it was made (Plan::stop) is no step, and ends the mission.
///
/// requests (may be null): what people ask of it, looked at before each planning step by the table
/// of drive modes (drive_mode.h), as in real time: the robot brakes and stands; an emergency stop
/// latches until it is acknowledged at rest. While it stands the mission waits, and with it the
/// robot's clock if that is a simulation's.
///
/// Does not throw, unless on_step(), `missing` or `cancelled` do: then the robot is brought to rest
/// first, in the same way, and the exception passed on.
MissionResult run_mission(LockstepRobot& robot, Replanner& planner, const Guard& guard,
                          const MissionOptions& options, DriveRequests* requests = nullptr);

}  // namespace prospect
