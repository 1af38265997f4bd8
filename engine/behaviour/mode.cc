// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/mode.h"

namespace prospect {

std::string_view to_string(ModeKind kind) {
  switch (kind) {
    case ModeKind::kExplore:
      return "explore";
    case ModeKind::kApproach:
      return "approach";
    case ModeKind::kLookAround:
      return "look around";
    case ModeKind::kRetreat:
      return "retreat";
    case ModeKind::kTurnOnTheSpot:
      return "turn on the spot";
    case ModeKind::kGoToGoal:
      return "go to goal";
    case ModeKind::kReturn:
      return "return";
    case ModeKind::kArrive:
      return "arrive";
    case ModeKind::kHold:
      return "hold";
    case ModeKind::kDone:
      return "done";
  }
  return "?";
}

std::string_view to_string(Cause cause) {
  switch (cause) {
    case Cause::kStart:
      return "start";
    case Cause::kLocalizationRegained:
      return "localization regained";
    case Cause::kRetreatTimedOut:
      return "retreat timed out";
    case Cause::kTurned:
      return "turned";
    case Cause::kProgress:
      return "progress";
    case Cause::kReachableAgain:
      return "reachable again";
    case Cause::kLocalizationLost:
      return "localization lost";
    case Cause::kFeaturesScarce:
      return "features scarce";
    case Cause::kStillLost:
      return "still lost";
    case Cause::kNotFollowing:
      return "commands not followed";
    case Cause::kNoProgress:
      return "no progress";
    case Cause::kNothingReachable:
      return "nothing reachable";
    case Cause::kExplored:
      return "explored";
    case Cause::kYieldTooLow:
      return "yield too low";
    case Cause::kUnreachable:
      return "unreachable";
    case Cause::kTaskGiven:
      return "task given";
    case Cause::kGoalNear:
      return "goal near";
    case Cause::kGoalReached:
      return "goal reached";
    case Cause::kReturned:
      return "returned";
    case Cause::kGoalUnreachable:
      return "goal unreachable";
  }
  return "?";
}

}  // namespace prospect
