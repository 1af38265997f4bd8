// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/behaviour.h"

#include <array>
#include <cmath>

#include "engine/behaviour/mode_policy.h"
#include "engine/behaviour/safety_level.h"
#include "models/formatted.h"
#include "models/knobs.h"

namespace prospect {
namespace {

using Kind = ModeKind;
using Case = ModeRow::Case;

// Stamps are sums of steps: a time is over although rounding says that a hair is missing.
constexpr double kHair = 1e-9;  // [s]

bool lost(const Case& c) { return c.facts.localization == Localization::kLost; }
bool retreating(const Case& c) { return c.before.mode.kind == Kind::kRetreat; }
bool paused(const Case& c) {
  return c.facts.stamp < c.before.retreat_ended + c.options.retreat_pause;
}
bool exhausted(const Case& c) {
  return c.facts.frontiers && c.facts.frontiers->exhausted &&
         c.facts.frontiers->exhausted_for >= c.options.look_around - kHair;
}

// Whether they promise so much that what has been seen is not all there is: a quarter of it.
bool much(double left, const FrontierFacts& f) {
  constexpr double kMuch = 0.25;
  return left > kMuch * f.explored_area;
}
// What no observation has decided: the robot did not get there.
double undecided(const FrontierFacts& f) { return f.unreachable.area + f.given_up.area; }
// What it saw from its start is not all there is where it would have driven and could not.
bool held_fast(const Facts& facts) {
  const bool hemmed_in = facts.frontiers && facts.frontiers->hemmed_in;
  return facts.strayed < kMoved && (!facts.refused.empty() || hemmed_in);
}

bool goal_unreachable(const Case& c) { return c.facts.goal && c.facts.goal->unreachable; }
bool goal_reached(const Case& c) { return c.facts.goal && c.facts.goal->reached && !lost(c); }

// Turning back at once from each loss, a robot never gets across a blank stretch that has no path
// round; exploring on while lost, it drifts. So in the pause it explores on, but not for long
// unless turning back was of no use.
bool impatient(const Case& c) {
  return c.before.enough_since_retreat && c.facts.lost_for > c.options.lost_patience;
}

constexpr std::array kModeTable = {
    ModeRow{std::nullopt, "task: hold",
            [](const Case& c) { return c.facts.task == TaskKind::kHold; }, Kind::kHold,
            Cause::kTaskGiven},
    ModeRow{std::nullopt, "task: go to; the goal is reached, not lost",
            [](const Case& c) { return c.facts.task == TaskKind::kGoTo && goal_reached(c); },
            Kind::kDone, Cause::kGoalReached},
    ModeRow{std::nullopt, "task: return; the start is reached, not lost",
            [](const Case& c) { return c.facts.task == TaskKind::kReturn && goal_reached(c); },
            Kind::kDone, Cause::kReturned},
    ModeRow{std::nullopt, "no path has led to the goal of the task for look_around",
            [](const Case& c) {
              return goal_unreachable(c) &&
                     c.facts.goal->unreachable_for >= c.options.look_around - kHair;
            },
            Kind::kDone, Cause::kGoalUnreachable},
    ModeRow{std::nullopt,
            "exhausted for look_around; nothing of the area that is to be explored was seen",
            [](const Case& c) { return exhausted(c) && c.facts.frontiers->area_unseen; },
            Kind::kDone, Cause::kUnreachable},
    ModeRow{std::nullopt,
            "exhausted for look_around; it never moved, and the certificate refused what it would "
            "have driven, or no place around it is passable",
            [](const Case& c) { return exhausted(c) && held_fast(c.facts); }, Kind::kDone,
            Cause::kUnreachable},
    ModeRow{std::nullopt,
            "exhausted for look_around; most places are cut off, or what is out of reach or was "
            "given up is expected to show a quarter of what was seen",
            [](const Case& c) {
              return exhausted(c) && (c.facts.frontiers->cut_off ||
                                      much(undecided(*c.facts.frontiers), *c.facts.frontiers));
            },
            Kind::kDone, Cause::kUnreachable},
    ModeRow{std::nullopt,
            "exhausted for look_around; what can be reached shows too little, or observations "
            "that were expected to show a quarter of what was seen have failed",
            [](const Case& c) {
              return exhausted(c) && (c.facts.frontiers->low_yield.count > 0 ||
                                      much(c.facts.frontiers->failed.area, *c.facts.frontiers));
            },
            Kind::kDone, Cause::kYieldTooLow},
    ModeRow{std::nullopt, "exhausted for look_around", [](const Case& c) { return exhausted(c); },
            Kind::kDone, Cause::kExplored},
    ModeRow{Kind::kRetreat, "too few features yet, not for longer than retreat_time",
            [](const Case& c) {
              return !c.facts.enough_features &&
                     !(c.facts.stamp - c.before.mode.since > c.options.retreat_time);
            },
            Kind::kRetreat, std::nullopt},
    ModeRow{std::nullopt,
            "localization lost; the last retreat is retreat_pause ago, or helped and "
            "lost_patience is over",
            [](const Case& c) { return !retreating(c) && lost(c) && (!paused(c) || impatient(c)); },
            Kind::kRetreat, Cause::kLocalizationLost},
    ModeRow{std::nullopt, "localization degraded; the last retreat is retreat_pause ago",
            [](const Case& c) {
              return !retreating(c) && c.facts.localization == Localization::kDegraded &&
                     !paused(c);
            },
            Kind::kRetreat, Cause::kFeaturesScarce},
    ModeRow{std::nullopt, "lost, for turn_time after a retreat that failed",
            [](const Case& c) {
              const double ended = retreating(c) ? c.facts.stamp : c.before.retreat_ended;
              return lost(c) && (retreating(c) || c.before.retreat_failed) &&
                     c.facts.stamp < ended + c.options.turn_time;
            },
            Kind::kTurnOnTheSpot, Cause::kStillLost},
    ModeRow{std::nullopt, "commands were not followed within the time of half a turn",
            [](const Case& c) {
              return c.facts.not_following_at &&
                     c.facts.stamp < *c.facts.not_following_at + c.options.turn_away_time;
            },
            Kind::kTurnOnTheSpot, Cause::kNotFollowing},
    ModeRow{std::nullopt, "exhausted: no frontier that can be reached is worth its path",
            [](const Case& c) { return c.facts.frontiers && c.facts.frontiers->exhausted; },
            Kind::kLookAround, Cause::kNothingReachable},
    ModeRow{
        std::nullopt, "no progress for long, not lost",
        [](const Case& c) { return c.facts.frontiers && c.facts.frontiers->stalled && !lost(c); },
        Kind::kApproach, Cause::kNoProgress},
    ModeRow{std::nullopt, "no path leads to the goal of the task",
            [](const Case& c) { return goal_unreachable(c); }, Kind::kLookAround,
            Cause::kNothingReachable},
    ModeRow{std::nullopt, "the goal of the task is near, not lost",
            [](const Case& c) { return c.facts.goal && c.facts.goal->near && !lost(c); },
            Kind::kArrive, Cause::kGoalNear},
    ModeRow{std::nullopt, "no progress to the goal of the task for long, not lost",
            [](const Case& c) { return c.facts.goal && c.facts.goal->stalled && !lost(c); },
            Kind::kApproach, Cause::kNoProgress},
    ModeRow{std::nullopt, "task: go to",
            [](const Case& c) { return c.facts.task == TaskKind::kGoTo; }, Kind::kGoToGoal,
            Cause::kTaskGiven},
    ModeRow{std::nullopt, "task: return",
            [](const Case& c) { return c.facts.task == TaskKind::kReturn; }, Kind::kReturn,
            Cause::kTaskGiven},
    ModeRow{Kind::kRetreat, "enough features",
            [](const Case& c) { return c.facts.enough_features; }, Kind::kExplore,
            Cause::kLocalizationRegained},
    ModeRow{Kind::kRetreat, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kRetreatTimedOut},
    ModeRow{Kind::kTurnOnTheSpot, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kTurned},
    ModeRow{Kind::kApproach, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kProgress},
    ModeRow{Kind::kLookAround, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kReachableAgain},
    ModeRow{Kind::kDone, "the task was given since then",
            [](const Case& c) { return c.facts.task_given_at > c.before.mode.since; },
            Kind::kExplore, Cause::kTaskGiven},
    ModeRow{Kind::kDone, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kReachableAgain},
    ModeRow{Kind::kGoToGoal, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kTaskGiven},
    ModeRow{Kind::kReturn, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kTaskGiven},
    ModeRow{Kind::kArrive, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kTaskGiven},
    ModeRow{Kind::kHold, "else", [](const Case&) { return true; }, Kind::kExplore,
            Cause::kTaskGiven},
    ModeRow{Kind::kExplore, "else", [](const Case&) { return true; }, Kind::kExplore, std::nullopt},
};

// A viewpoint so near is where the robot stands: what is left is to turn.
constexpr double kThere = 0.15;  // [m]

std::string localization_text(const Facts& f) {
  switch (f.localization) {
    case Localization::kOk:
      return "localization is back, but on too little yet";
    case Localization::kDegraded:
      return "localization is degraded";
    case Localization::kLost:
      return std::isfinite(f.lost_for) && f.lost_for < 1e6
                 ? formatted("localization is lost for %.1f s", f.lost_for)
                 : "localization is lost";
  }
  return "";
}

std::string target_text(const FrontierFacts& f) {
  if (f.to_area) {
    return formatted(
        "drives %.1f m to the area that is to be explored, %.1f m of them through unknown space",
        f.path_left, f.unknown_left);
  }
  return (f.path_left < kThere ? std::string("looks from here")
                               : formatted("drives %.1f m to look", f.path_left)) +
         formatted(" at a frontier %.1f m long, which promises %.1f m2", f.target_length,
                   f.target_area);
}

std::string left_text(const FrontierFacts& f) {
  std::string text;
  const auto add = [&](const FrontiersLeft& left, const char* what) {
    if (left.count == 0) return;
    text +=
        formatted("%s %d (%.1f m2) ", text.empty() ? "; left:" : ",", left.count, left.area) + what;
  };
  add(f.low_yield, "too little for the way");
  add(f.failed, "where looks showed nothing");
  add(f.given_up, "given up on the way there");
  add(f.unreachable, "out of reach");
  if (f.barred.count > 0) {
    text += formatted("%s %d (%.1f m2) that %s bars", text.empty() ? "; left:" : ",",
                      f.barred.count, f.barred.area, f.barred_by.c_str());
  }
  if (!f.area_why.empty() && !f.area_unseen) {
    text += "; the rest of the area is not reached: " + f.area_why;
  }
  return text;
}

/// "3.2 m to the goal, 1.1 m of them through unknown space"
std::string path_text(const Facts& facts) {
  const char* place = facts.task == TaskKind::kReturn ? "where it began" : "the goal";
  if (!facts.goal) return std::string("to ") + place;
  const GoalFacts& goal = *facts.goal;
  std::string text = formatted("%.1f m to %s", goal.path_left, place);
  if (goal.unknown_left > 0.0) {
    text += formatted(", %.1f m of them through unknown space", goal.unknown_left);
  }
  return text;
}

/// How an exploration ended.
std::string exploration_end_text(const Mode& mode, const Facts& facts) {
  const FrontierFacts f = facts.frontiers.value_or(FrontierFacts{});
  if (mode.cause == Cause::kExplored) {
    return "Done: no frontier is left that can be reached and promises anything";
  }
  if (mode.cause == Cause::kYieldTooLow) return "Done: what is left shows too little for the way";
  if (f.area_unseen) {
    return "Ended: nothing of the area that is to be explored can be reached: " + f.area_why;
  }
  if (held_fast(facts)) {
    return "Ended: it could not get away from where it began" +
           (facts.refused.empty() ? ": no place around it is passable" : ": " + facts.refused);
  }
  return f.cut_off ? "Ended: walls as drawn cut it off from most places it came through"
                   : "Ended: no way is found to most of what is left";
}

/// Since when, and what was before.
std::string explore_cause_text(const Mode& mode, const Facts& facts) {
  if (facts.localization == Localization::kLost) {
    return "; " + localization_text(facts) + ", and it goes on for a while before it turns back";
  }
  const double ago = facts.stamp - mode.since;
  switch (mode.cause) {
    case Cause::kLocalizationRegained:
      return formatted("; localization was regained %.0f s ago", ago);
    case Cause::kRetreatTimedOut:
      return formatted("; a retreat without success ended %.0f s ago", ago);
    case Cause::kTurned:
      return formatted("; it turned until %.0f s ago", ago);
    case Cause::kReachableAgain:
      return formatted("; frontiers are reachable again since %.0f s", ago);
    default:
      return "";
  }
}

std::string doing(const Mode& mode, const Facts& facts) {
  const FrontierFacts frontiers = facts.frontiers.value_or(FrontierFacts{});
  switch (mode.kind) {
    case Kind::kExplore:
      if (!frontiers.target) {
        return "Explores: no frontier can be reached from here just now" +
               explore_cause_text(mode, facts);
      }
      return "Explores: " + target_text(frontiers) + explore_cause_text(mode, facts);
    case Kind::kApproach:
      if (facts.goal) {
        return formatted("Approaches step by step for %.1f s now, for want of progress: ",
                         facts.stamp - mode.since) +
               path_text(facts);
      }
      return formatted("Approaches step by step for %.1f s now, for want of progress: %s",
                       facts.stamp - mode.since, target_text(frontiers).c_str());
    case Kind::kLookAround:
      if (facts.goal) {
        return formatted("Looks around: for %.1f s no way has led to ",
                         facts.goal->unreachable_for) +
               (facts.task == TaskKind::kReturn ? "where it began: " : "the goal: ") +
               facts.goal->why;
      }
      return formatted("Looks around: for %.1f s no frontier that can be reached was worth its way",
                       frontiers.exhausted_for);
    case Kind::kRetreat: {
      if (!facts.rests_on_features) return "Turns back: " + localization_text(facts);
      std::string text =
          formatted("Turns back: %d features in view, ", facts.tracked) + localization_text(facts);
      if (facts.tracked_at_retreat > 0) {
        text += formatted("; %d were tracked %.1f m from here", facts.tracked_at_retreat,
                          facts.retreat_distance);
      }
      return text;
    }
    case Kind::kTurnOnTheSpot:
      if (mode.cause == Cause::kNotFollowing) {
        return "Turns away: it did not move as it was told to, so something is where the map has "
               "nothing";
      }
      return "Turns on the spot to find its localization again: turning back did not help, " +
             localization_text(facts);
    case Kind::kGoToGoal:
    case Kind::kReturn:
      return (mode.kind == Kind::kReturn ? "Returns: " : "Goes where it is told: ") +
             path_text(facts);
    case Kind::kArrive:
      return formatted("Arrives: %.2f m to ", facts.goal.value_or(GoalFacts{}).distance) +
             (facts.task == TaskKind::kReturn ? "where it began" : "the goal");
    case Kind::kHold:
      return "Holds: it was told to";
    case Kind::kDone:
      if (mode.cause == Cause::kGoalReached || mode.cause == Cause::kReturned) {
        const GoalFacts goal = facts.goal.value_or(GoalFacts{});
        std::string text = formatted("Done: %.2f m from ", goal.distance) +
                           (mode.cause == Cause::kReturned ? "where it began" : "the goal");
        if (goal.heading_missed) {
          text += formatted(", %.0f degrees off the heading there: ",
                            *goal.heading_missed * 180.0 / M_PI) +
                  goal.heading_why;
        }
        return text;
      }
      if (mode.cause == Cause::kGoalUnreachable) {
        return (facts.task == TaskKind::kReturn ? "Done: it cannot get back to where it began: "
                                                : "Done: the goal cannot be reached: ") +
               facts.goal.value_or(GoalFacts{}).why;
      }
      return exploration_end_text(mode, facts) + left_text(frontiers);
  }
  return "";
}

}  // namespace

std::string_view to_string(TargetChange change) {
  switch (change) {
    case TargetChange::kNone:
      return "";
    case TargetChange::kFirst:
      return "first";
    case TargetChange::kSeen:
      return "seen";
    case TargetChange::kUnreachable:
      return "unreachable";
    case TargetChange::kNoProgress:
      return "no progress";
    case TargetChange::kLost:
      return "lost";
    case TargetChange::kBetter:
      return "better";
  }
  return "?";
}

std::span<const ModeRow> mode_table() { return kModeTable; }

const ModeRow& deciding_row(const Behaviour& before, const Facts& facts,
                            const BehaviourOptions& options) {
  const Case c{before, facts, options};
  for (const ModeRow& row : kModeTable) {
    if (row.from && *row.from != before.mode.kind) continue;
    if (row.holds(c)) return row;
  }
  return kModeTable.back();
}

Behaviour decide(const Behaviour& before, const Facts& facts, const BehaviourOptions& options) {
  const ModeRow& row = deciding_row(before, facts, options);
  Behaviour now = before;
  now.mode.kind = row.to;
  now.mode.cause = row.cause.value_or(before.mode.cause);
  if (now.mode.kind != before.mode.kind || now.mode.cause != before.mode.cause) {
    now.mode.since = facts.stamp;
  }
  const bool retreated = before.mode.kind == Kind::kRetreat;
  if (retreated && now.mode.kind != Kind::kRetreat) {
    now.retreat_ended = facts.stamp;
    now.retreat_failed = !facts.enough_features;
    now.enough_since_retreat = facts.enough_features;
  } else if (!retreated) {
    now.enough_since_retreat = before.enough_since_retreat || facts.enough_features;
  }
  return now;
}

std::string describe(const Mode& mode, const Facts& facts) {
  std::string text = doing(mode, facts) + '.';
  if (mode.kind == Kind::kDone) {
    if (mode.cause == Cause::kGoalUnreachable && facts.strayed < kMoved && !facts.refused.empty()) {
      text += " It has not moved: " + facts.refused + '.';
    }
    return text;
  }
  const bool narrow = facts.frontiers && facts.frontiers->narrow;
  if (narrow) text += " The way ahead is narrow.";
  if (facts.stuck && !narrow) {
    text += " It is stuck: no way out keeps the distances, so it keeps from touching, no more.";
  }
  return text;
}

std::string behaviour_tables() {
  std::string text =
      "What the robot does next. The first row that holds is taken.\n\n"
      "| from | condition | to | cause |\n|---|---|---|---|\n";
  for (const ModeRow& row : kModeTable) {
    text += "| " + std::string(row.from ? to_string(*row.from) : "any") + " | " +
            std::string(row.condition) + " | " + std::string(to_string(row.to)) + " | " +
            std::string(row.cause ? to_string(*row.cause) : "as before") + " |\n";
  }
  text +=
      "\nWhat a mode means for the planning problem.\n\n"
      "| mode | weight of exploration | weight of features | features | cost-to-go | seeds | time "
      "without progress counts |\n|---|---|---|---|---|---|---|\n";
  for (const ModeKind kind : kModeKinds) {
    if (kind == Kind::kDone) continue;
    const ModePolicy& p = policy(kind);
    text += formatted("| %s | %g | %g | %s | %s | %s | %s |\n", to_string(kind).data(),
                      p.exploration_weight, p.features_weight,
                      p.count_features ? "counted" : "as set", to_string(p.cost_to_go).data(),
                      to_string(p.seeds).data(), p.pursues ? "yes" : "no");
  }
  text +=
      "\nThe plan of the step that finds the robot done is that of the mode which the rows without "
      "frontiers give: a retreat or a turn goes on. At the end of another task than to explore it "
      "is "
      "that of hold.\n"
      "\nWhich distances it keeps. The first row that holds is taken.\n\n"
      "| condition | safety level |\n|---|---|\n";
  for (const SafetyLevelRow& row : safety_level_table()) {
    text += "| " + std::string(row.condition) + " | " + std::string(to_string(row.safety_level)) +
            " |\n";
  }
  text +=
      "\nWhat a safety level means for the certificate and the problem.\n\n"
      "| safety level | share of the margin | kept of the distance within it | drift "
      "counts | ... as a margin | ... in the cost | hard clearance |\n"
      "|---|---|---|---|---|---|---|\n";
  const auto yes = [](bool value) { return value ? "yes" : "no"; };
  for (const SafetyLevel safety_level : kSafetyLevels) {
    const SafetyLevelPolicy& p = policy(safety_level);
    text += formatted("| %s | %g | %g | %s | %s | %s | %s |\n", to_string(safety_level).data(),
                      p.margin, p.reduced_margin_share, yes(p.drift), yes(p.drift_margin),
                      yes(p.drift_in_cost), yes(p.hard_clearance));
  }
  return text;
}

void describe(Knobs& knobs, BehaviourOptions& o) {
  knobs.number("retreat_time", o.retreat_time, {0.0, 600.0}, "s", "longest single attempt");
  knobs.number("turn_time", o.turn_time, {0.0, 600.0}, "s", "on the spot, if still lost after it");
  knobs.number("retreat_pause", o.retreat_pause, {0.0, 3600.0}, "s", "before the next attempt");
  knobs.number("lost_patience", o.lost_patience, {0.0, 3600.0}, "s",
               "in the pause, that a robot which got lost anew explores on");
  knobs.number("look_around", o.look_around, {0.0, 3600.0}, "s",
               "without anything that can be reached, before the task is over");
}

}  // namespace prospect
