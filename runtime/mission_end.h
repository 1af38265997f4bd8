// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/behaviour/mode.h"

namespace prospect {

/// How a mission ended.
enum class MissionEnd : std::uint8_t {
  kExplored,         ///< no frontier is left that can be reached and promises anything
  kYieldTooLow,      ///< what is left and can be reached shows too little for the path
  kUnreachable,      ///< much is left, or all that was asked for, but no path leads there
  kEnough,           ///< MissionOptions::missing: nothing is
  kTooLittle,        ///< nothing is left to explore, and MissionOptions::missing: something is
  kGoalReached,      ///< the robot is at the pose that it was told to go to
  kReturned,         ///< it is back where it began
  kGoalUnreachable,  ///< no path leads to the goal, or back
  kTimeLimit,
  kLost,  ///< localization was lost and did not come back
  kCancelled,
  kNotFit,  ///< a check before the first motion has failed (preflight.h), or the maps' resolution
            ///< does not fit the planner (PlanFault::kMisfit)
  kFallen,  ///< over an edge or into a hole (TrueState::fallen)
  kRobotLost,     ///< it does not answer any more (LockstepRobot::fault())
  kUnexplained,   ///< the planner says that it is done, and no cause that ends a task
  kLogEndsEarly,  ///< of a log that ends before its mission did: nobody knows
};

/// What an end says of the task.
enum class Outcome : std::uint8_t {
  kDone,      ///< it was done
  kNotDone,   ///< it was not, and the robot is as it should be
  kFailed,    ///< something is wrong with the robot or its planner
  kCancelled  ///< somebody ended it
};

/// "done", "not done", "failed", "cancelled".
std::string_view to_string(Outcome outcome);

/// All that is to be known of an end. What else speaks of ends (exit code, colours, studies) asks
/// for `outcome`.
struct MissionEndRow {
  MissionEnd end;
  std::string_view name;     ///< as summary.json and the report have it
  std::string_view meaning;  ///< a sentence
  Outcome outcome;
};

/// A row for each MissionEnd, in their order.
std::span<const MissionEndRow> mission_ends();
const MissionEndRow& row_of(MissionEnd end);
/// None: no end is named so.
std::optional<MissionEnd> mission_end_named(std::string_view name);
inline std::string_view to_string(MissionEnd end) { return row_of(end).name; }

/// The end of a mission whose planner is done (ModeKind::kDone) for this cause. Total: a cause that
/// ends no task is kUnexplained.
MissionEnd end_for(Cause cause);

/// The table as text for people, Markdown.
std::string mission_end_table();

}  // namespace prospect
