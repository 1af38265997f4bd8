// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace prospect {

/// What the robot is doing.
enum class ModeKind {
  kExplore,     ///< drives to the frontiers, all seeds, optimised
  kApproach,    ///< drives the path to its target step by step and faces what is to be seen there
  kLookAround,  ///< turns on the spot: the map may show a path then
  kRetreat,     ///< goes back to where enough features were tracked
  kTurnOnTheSpot,  ///< turns until it is localized again, or away from what holds it up
  kGoToGoal,       ///< drives to the pose that it was told to go to
  kReturn,         ///< drives back to where it began
  kArrive,         ///< drives the last bit to a goal, and turns to its heading
  kHold,           ///< brakes and stays
  kDone            ///< nothing more to do
};

/// Why a mode was entered.
enum class Cause {
  kStart,
  kLocalizationRegained,  ///< enough features are tracked again
  kRetreatTimedOut,       ///< the retreat took too long
  kTurned,                ///< the turn is over
  kProgress,              ///< the target has moved, or something new was seen
  kReachableAgain,        ///< a frontier can be reached again
  kLocalizationLost,
  kFeaturesScarce,    ///< localization is degraded
  kStillLost,         ///< a retreat did not bring localization back
  kNotFollowing,      ///< the robot does not move as it is told to
  kNoProgress,        ///< neither nearer to the target nor anything new seen
  kNothingReachable,  ///< no frontier can be reached just now
  kExplored,          ///< no frontier is left that can be reached
  kYieldTooLow,       ///< what is left has shown too little for too long
  kUnreachable,       ///< much is left and no path leads there, as the map draws walls
  kTaskGiven,         ///< the robot was told to
  kGoalNear,          ///< a short, known path to the goal is left
  kGoalReached,       ///< it is at the pose that it was told to go to
  kReturned,          ///< it is back where it began
  kGoalUnreachable    ///< no path leads to the goal
};

struct Mode {
  ModeKind kind = ModeKind::kExplore;
  Cause cause = Cause::kStart;
  double since = 0.0;  ///< [s] when it was entered, or its cause changed
};

inline constexpr std::array kModeKinds = {
    ModeKind::kExplore,       ModeKind::kApproach, ModeKind::kLookAround, ModeKind::kRetreat,
    ModeKind::kTurnOnTheSpot, ModeKind::kGoToGoal, ModeKind::kReturn,     ModeKind::kArrive,
    ModeKind::kHold,          ModeKind::kDone};

/// "explore", "approach", "look around", "retreat", "turn on the spot", "go to goal", "return",
/// "arrive", "hold", "done".
std::string_view to_string(ModeKind kind);
/// "start", "localization regained", ...
std::string_view to_string(Cause cause);

}  // namespace prospect
