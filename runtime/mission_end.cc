// SPDX-License-Identifier: Apache-2.0
#include "runtime/mission_end.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace prospect {
namespace {

using End = MissionEnd;

constexpr std::array kMissionEnds = {
    MissionEndRow{End::kExplored, "explored",
                  "No frontier is left that can be reached and would show anything.",
                  Outcome::kDone},
    MissionEndRow{End::kYieldTooLow, "yield too low",
                  "What is left and can be reached shows too little for its path.", Outcome::kDone},
    MissionEndRow{End::kUnreachable, "unreachable",
                  "Much is left, or all that was asked for, and no path leads there; or the robot "
                  "could not get away from its start.",
                  Outcome::kNotDone},
    MissionEndRow{End::kEnough, "enough seen", "As much was seen as `--until` asked for.",
                  Outcome::kDone},
    MissionEndRow{End::kTooLittle, "too little seen",
                  "Nothing is left to explore, and less was seen than `--until` asked for.",
                  Outcome::kNotDone},
    MissionEndRow{End::kGoalReached, "goal reached",
                  "The robot is where it was told to go, at the heading asked for if that can be "
                  "had.",
                  Outcome::kDone},
    MissionEndRow{End::kReturned, "returned", "It is back where it began, likewise.",
                  Outcome::kDone},
    MissionEndRow{End::kGoalUnreachable, "goal unreachable",
                  "No path leads to the goal, or back to the start.", Outcome::kNotDone},
    MissionEndRow{End::kTimeLimit, "time limit",
                  "Time was up, or was only just enough for the path back.", Outcome::kNotDone},
    MissionEndRow{End::kLost, "localization lost", "Localization was lost and did not come back.",
                  Outcome::kFailed},
    MissionEndRow{End::kCancelled, "cancelled", "A signal or a person ended it.",
                  Outcome::kCancelled},
    MissionEndRow{End::kNotFit, "not fit to drive", "A check before the first motion has failed.",
                  Outcome::kFailed},
    MissionEndRow{End::kFallen, "fallen",
                  "A wheel stood where there is no floor: an edge, a stair down or a hole.",
                  Outcome::kFailed},
    MissionEndRow{End::kRobotLost, "robot lost", "Its simulation does not answer any more.",
                  Outcome::kFailed},
    MissionEndRow{End::kUnexplained, "ended without a cause",
                  "The planner says that it is done, and not why: a fault of the planner.",
                  Outcome::kFailed},
    MissionEndRow{End::kLogEndsEarly, "log ends early",
                  "The log ends before the mission did: how it ended is not known.",
                  Outcome::kFailed},
};

constexpr bool in_order() {
  for (std::size_t n = 0; n < kMissionEnds.size(); ++n) {
    if (static_cast<std::size_t>(kMissionEnds[n].end) != n) return false;
  }
  return true;
}
static_assert(in_order());

}  // namespace

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kDone:
      return "done";
    case Outcome::kNotDone:
      return "not done";
    case Outcome::kFailed:
      return "failed";
    case Outcome::kCancelled:
      return "cancelled";
  }
  return "?";
}

std::span<const MissionEndRow> mission_ends() { return kMissionEnds; }

const MissionEndRow& row_of(MissionEnd end) { return kMissionEnds[static_cast<std::size_t>(end)]; }

std::optional<MissionEnd> mission_end_named(std::string_view name) {
  const auto row = std::find_if(kMissionEnds.begin(), kMissionEnds.end(),
                                [&](const MissionEndRow& r) { return r.name == name; });
  return row == kMissionEnds.end() ? std::nullopt : std::optional(row->end);
}

// Without a default: a new cause does not compile until it is said here what it ends.
MissionEnd end_for(Cause cause) {
  switch (cause) {
    case Cause::kExplored:
      return MissionEnd::kExplored;
    case Cause::kYieldTooLow:
      return MissionEnd::kYieldTooLow;
    case Cause::kUnreachable:
      return MissionEnd::kUnreachable;
    case Cause::kGoalReached:
      return MissionEnd::kGoalReached;
    case Cause::kReturned:
      return MissionEnd::kReturned;
    case Cause::kGoalUnreachable:
      return MissionEnd::kGoalUnreachable;
    case Cause::kStart:
    case Cause::kLocalizationRegained:
    case Cause::kRetreatTimedOut:
    case Cause::kTurned:
    case Cause::kProgress:
    case Cause::kReachableAgain:
    case Cause::kLocalizationLost:
    case Cause::kFeaturesScarce:
    case Cause::kStillLost:
    case Cause::kNotFollowing:
    case Cause::kNoProgress:
    case Cause::kNothingReachable:
    case Cause::kTaskGiven:
    case Cause::kGoalNear:
      break;
  }
  return MissionEnd::kUnexplained;
}

std::string mission_end_table() {
  std::string text = "| `reason` | what happened | `outcome` |\n|---|---|---|\n";
  for (const MissionEndRow& row : kMissionEnds) {
    text += "| `" + std::string(row.name) + "` | " + std::string(row.meaning) + " | " +
            std::string(to_string(row.outcome)) + " |\n";
  }
  return text;
}

}  // namespace prospect
