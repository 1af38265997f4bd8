// SPDX-License-Identifier: Apache-2.0
#include "runtime/drive_mode.h"

namespace prospect {
namespace {

using enum DriveMode;
using Case = DriveModeRow::Case;

// Stamps are sums of periods: a time is over although rounding says that a hair is missing.
constexpr double kHair = 1e-9;  // [s]

template <typename... Modes>
constexpr DriveModeSet set(Modes... modes) {
  return {((1U << static_cast<unsigned>(modes)) | ...)};
}
constexpr DriveModeSet kAny = set(kIdle, kReady, kActive, kDegraded, kStopping, kStopped);
constexpr DriveModeSet kDriving = set(kActive, kDegraded);
constexpr DriveModeSet kMoving = set(kActive, kDegraded, kStopping);
constexpr DriveModeSet kStanding = set(kIdle, kReady);

constexpr bool always(const Case&) { return true; }
bool at_rest(const Case& c) { return c.facts.rest_for >= c.options.rest_time - kHair; }
bool base_fault(const Case& c) { return !c.facts.base_fault.empty(); }
bool base_silent(const Case& c) { return c.facts.base_silent; }
bool thread_ended(const Case& c) { return !c.facts.ended_thread.empty(); }
bool thread_late(const Case& c) { return !c.facts.late_thread.empty(); }
bool preflight_failed(const Case& c) { return !c.facts.failed_preflight.empty(); }
bool stop_silent(const Case& c) { return !c.facts.silent_emergency_stop.empty(); }
bool does_not_follow(const Case& c) { return !c.facts.not_following.empty(); }
bool obstacle(const Case& c) { return !c.facts.obstacle.empty(); }
bool lost(const Case& c) { return c.facts.localization == Localization::kLost; }

bool latching_cause(const Case& c) {
  return c.facts.emergency_stop || stop_silent(c) || base_fault(c) || base_silent(c) ||
         thread_ended(c) || c.facts.uncommanded_motion || does_not_follow(c);
}
bool new_plan(const Case& c) {
  return c.facts.plan_from_rest && *c.facts.plan_from_rest > c.before.since &&
         c.facts.plan_left > 0.0;
}

constexpr std::array kTable = {
    DriveModeRow{
        set(kStopped), "acknowledged, at rest for rest_time, nothing that latches holds",
        [](const Case& c) { return c.facts.acknowledged && at_rest(c) && !latching_cause(c); },
        kIdle, DriveCause::kAcknowledged},
    DriveModeRow{set(kStopped), "else", always, kStopped, std::nullopt},
    DriveModeRow{kAny, "an emergency stop is asked for",
                 [](const Case& c) { return c.facts.emergency_stop; }, kStopping,
                 DriveCause::kEmergencyStop},
    DriveModeRow{kMoving, "the emergency stop is silent", stop_silent, kStopping,
                 DriveCause::kEmergencyStopSilent},
    DriveModeRow{kMoving, "the base reports a fault", base_fault, kStopping,
                 DriveCause::kBaseFault},
    DriveModeRow{kMoving, "the base is silent", base_silent, kStopping, DriveCause::kBaseSilent},
    DriveModeRow{kMoving, "a thread has ended", thread_ended, kStopping, DriveCause::kThreadEnded},
    DriveModeRow{set(kReady, kActive, kDegraded, kStopping),
                 "the base moves otherwise than it is told to",
                 [](const Case& c) { return c.facts.uncommanded_motion; }, kStopping,
                 DriveCause::kUncommandedMotion},
    DriveModeRow{set(kReady, kActive, kDegraded, kStopping),
                 "the base does not follow what it is told", does_not_follow, kStopping,
                 DriveCause::kDoesNotFollow},
    DriveModeRow{set(kStopping), "at rest for rest_time; the cause latches",
                 [](const Case& c) { return at_rest(c) && latches(c.before.cause); }, kStopped,
                 std::nullopt},
    DriveModeRow{set(kStopping), "the cause latches",
                 [](const Case& c) { return latches(c.before.cause); }, kStopping, std::nullopt},
    DriveModeRow{set(kStopping), "at rest for rest_time", at_rest, kIdle, std::nullopt},
    DriveModeRow{set(kStopping), "not at rest within stop_time",
                 [](const Case& c) {
                   return !(c.facts.stamp - c.before.since <= c.options.stop_time + kHair);
                 },
                 kStopping, DriveCause::kDoesNotStop},
    DriveModeRow{kMoving, "ranges show an obstacle that stops the command in force", obstacle,
                 kStopping, DriveCause::kObstacle},
    DriveModeRow{kMoving, "a thread is late", thread_late, kStopping, DriveCause::kThreadLate},
    DriveModeRow{kDriving, "a pre-flight check has failed, or was not made", preflight_failed,
                 kStopping, DriveCause::kPreflight},
    DriveModeRow{kDriving, "a clock has jumped",
                 [](const Case& c) { return !c.facts.jumped_clock.empty(); }, kStopping,
                 DriveCause::kClockJumped},
    DriveModeRow{kDriving, "a pose from outside has jumped",
                 [](const Case& c) { return !c.facts.jumped_pose.empty(); }, kStopping,
                 DriveCause::kPoseJumped},
    DriveModeRow{kDriving, "a source is stale",
                 [](const Case& c) { return !c.facts.stale_source.empty(); }, kStopping,
                 DriveCause::kSourceStale},
    DriveModeRow{kDriving, "the plan is over",
                 [](const Case& c) { return !(c.facts.plan_left > 0.0); }, kStopping,
                 DriveCause::kPlanOver},
    DriveModeRow{kDriving, "told to stand", [](const Case& c) { return !c.facts.told_to_drive; },
                 kStopping, DriveCause::kToldToStand},
    DriveModeRow{kDriving, "the task is over", [](const Case& c) { return c.facts.task_over; },
                 kStopping, DriveCause::kTaskOver},
    DriveModeRow{set(kStopping), "else", always, kStopping, std::nullopt},
    DriveModeRow{kStanding, "the emergency stop is silent", stop_silent, kIdle,
                 DriveCause::kEmergencyStopSilent},
    DriveModeRow{kStanding, "the base reports a fault", base_fault, kIdle, DriveCause::kBaseFault},
    DriveModeRow{kStanding, "the base is silent", base_silent, kIdle, DriveCause::kBaseSilent},
    DriveModeRow{kStanding, "a thread has ended", thread_ended, kIdle, DriveCause::kThreadEnded},
    DriveModeRow{kStanding, "a thread is late", thread_late, kIdle, DriveCause::kThreadLate},
    DriveModeRow{kStanding, "a pre-flight check has failed, or was not made", preflight_failed,
                 kIdle, DriveCause::kPreflight},
    DriveModeRow{kStanding, "not all sources have been live for live_time",
                 [](const Case& c) {
                   return !c.facts.stale_source.empty() ||
                          !(c.facts.live_for >= c.options.live_time - kHair);
                 },
                 kIdle, DriveCause::kSourceStale},
    DriveModeRow{set(kIdle), "else", always, kReady, DriveCause::kSourcesLive},
    DriveModeRow{set(kReady), "ranges show an obstacle that stops the next command", obstacle,
                 kReady, DriveCause::kObstacle},
    DriveModeRow{
        set(kReady), "told to drive; a plan from rest was made since, and is not over",
        [](const Case& c) { return c.facts.told_to_drive && !c.facts.task_over && new_plan(c); },
        kActive, DriveCause::kNewPlan},
    DriveModeRow{set(kReady), "else", always, kReady, DriveCause::kSourcesLive},
    DriveModeRow{kDriving, "localization lost", lost, kDegraded, DriveCause::kLocalizationLost},
    DriveModeRow{kDriving, "yaw is not checked yet",
                 [](const Case& c) { return !c.facts.yaw_checked; }, kDegraded,
                 DriveCause::kYawUnchecked},
    DriveModeRow{kDriving, "localization degraded",
                 [](const Case& c) { return c.facts.localization == Localization::kDegraded; },
                 kDegraded, DriveCause::kLocalizationDegraded},
    DriveModeRow{
        set(kDegraded), "localization ok for recover_time",
        [](const Case& c) { return c.facts.localized_for >= c.options.recover_time - kHair; },
        kActive, DriveCause::kLocalizationRegained},
    DriveModeRow{set(kDegraded), "else", always, kDegraded, std::nullopt},
    DriveModeRow{set(kActive), "else", always, kActive, std::nullopt},
};

using Response = DriveResponse;
constexpr std::array kPolicies = {
    DriveCausePolicy{DriveCause::kLocalizationLost, Response::kSlow, &DriveModeOptions::lost_share,
                     false},
    DriveCausePolicy{DriveCause::kYawUnchecked, Response::kSlow, &DriveModeOptions::unchecked_share,
                     false},
    DriveCausePolicy{DriveCause::kLocalizationDegraded, Response::kSlow,
                     &DriveModeOptions::degraded_share, false},
    DriveCausePolicy{DriveCause::kPreflight, Response::kComfortStop, nullptr, false},
    DriveCausePolicy{DriveCause::kClockJumped, Response::kComfortStop, nullptr, false},
    DriveCausePolicy{DriveCause::kPoseJumped, Response::kEmergencyStop, nullptr, false},
    DriveCausePolicy{DriveCause::kSourceStale, Response::kComfortStop, nullptr, false},
    DriveCausePolicy{DriveCause::kPlanOver, Response::kComfortStop, nullptr, false},
    DriveCausePolicy{DriveCause::kToldToStand, Response::kComfortStop, nullptr, false},
    DriveCausePolicy{DriveCause::kTaskOver, Response::kComfortStop, nullptr, false},
    DriveCausePolicy{DriveCause::kObstacle, Response::kEmergencyStop, nullptr, false},
    DriveCausePolicy{DriveCause::kThreadLate, Response::kEmergencyStop, nullptr, false},
    DriveCausePolicy{DriveCause::kEmergencyStop, Response::kEmergencyStop, nullptr, true},
    DriveCausePolicy{DriveCause::kEmergencyStopSilent, Response::kEmergencyStop, nullptr, true},
    DriveCausePolicy{DriveCause::kBaseFault, Response::kEmergencyStop, nullptr, true},
    DriveCausePolicy{DriveCause::kBaseSilent, Response::kEmergencyStop, nullptr, true},
    DriveCausePolicy{DriveCause::kThreadEnded, Response::kEmergencyStop, nullptr, true},
    DriveCausePolicy{DriveCause::kUncommandedMotion, Response::kEmergencyStop, nullptr, true},
    DriveCausePolicy{DriveCause::kDoesNotFollow, Response::kEmergencyStop, nullptr, true},
    DriveCausePolicy{DriveCause::kDoesNotStop, Response::kEmergencyStop, nullptr, true},
};

const DriveCausePolicy* policy_of(DriveCause cause) {
  for (const DriveCausePolicy& policy : kPolicies) {
    if (policy.cause == cause) return &policy;
  }
  return nullptr;
}

std::string_view name_of(double DriveModeOptions::*share) {
  if (share == &DriveModeOptions::degraded_share) return "degraded_share";
  if (share == &DriveModeOptions::lost_share) return "lost_share";
  return "unchecked_share";
}

// What is at fault, by name; empty if no fact has one for the cause.
std::string_view named(DriveCause cause, const DriveFacts& facts) {
  switch (cause) {
    case DriveCause::kPreflight:
      return facts.failed_preflight;
    case DriveCause::kClockJumped:
      return facts.jumped_clock;
    case DriveCause::kPoseJumped:
      return facts.jumped_pose;
    case DriveCause::kSourceStale:
      return facts.stale_source;
    case DriveCause::kObstacle:
      return facts.obstacle;
    case DriveCause::kThreadLate:
      return facts.late_thread;
    case DriveCause::kThreadEnded:
      return facts.ended_thread;
    case DriveCause::kEmergencyStopSilent:
      return facts.silent_emergency_stop;
    case DriveCause::kBaseFault:
      return facts.base_fault;
    case DriveCause::kDoesNotFollow:
      return facts.not_following;
    default:
      return {};
  }
}

}  // namespace

std::string_view to_string(DriveMode mode) {
  switch (mode) {
    case kIdle:
      return "idle";
    case kReady:
      return "ready";
    case kActive:
      return "active";
    case kDegraded:
      return "degraded";
    case kStopping:
      return "stopping";
    case kStopped:
      return "stopped";
  }
  return "?";
}

std::string_view to_string(DriveCause cause) {
  switch (cause) {
    case DriveCause::kStart:
      return "start";
    case DriveCause::kAcknowledged:
      return "acknowledged";
    case DriveCause::kSourcesLive:
      return "sources live";
    case DriveCause::kNewPlan:
      return "new plan";
    case DriveCause::kLocalizationRegained:
      return "localization regained";
    case DriveCause::kLocalizationLost:
      return "localization lost";
    case DriveCause::kYawUnchecked:
      return "yaw unchecked";
    case DriveCause::kLocalizationDegraded:
      return "localization degraded";
    case DriveCause::kPreflight:
      return "pre-flight";
    case DriveCause::kClockJumped:
      return "clock jumped";
    case DriveCause::kPoseJumped:
      return "pose jumped";
    case DriveCause::kSourceStale:
      return "source stale";
    case DriveCause::kPlanOver:
      return "plan over";
    case DriveCause::kToldToStand:
      return "told to stand";
    case DriveCause::kTaskOver:
      return "task over";
    case DriveCause::kObstacle:
      return "obstacle";
    case DriveCause::kThreadLate:
      return "thread late";
    case DriveCause::kEmergencyStop:
      return "emergency stop";
    case DriveCause::kEmergencyStopSilent:
      return "emergency stop silent";
    case DriveCause::kBaseFault:
      return "base fault";
    case DriveCause::kBaseSilent:
      return "base silent";
    case DriveCause::kThreadEnded:
      return "thread ended";
    case DriveCause::kUncommandedMotion:
      return "uncommanded motion";
    case DriveCause::kDoesNotFollow:
      return "does not follow";
    case DriveCause::kDoesNotStop:
      return "does not stop";
  }
  return "?";
}

std::string_view to_string(DriveResponse response) {
  switch (response) {
    case Response::kStand:
      return "stand";
    case Response::kFull:
      return "full speed";
    case Response::kSlow:
      return "slower";
    case Response::kComfortStop:
      return "comfort stop";
    case Response::kEmergencyStop:
      return "emergency stop";
  }
  return "?";
}

std::string to_string(DriveModeSet modes) {
  if (modes.bits == kAny.bits) return "any";
  std::string text;
  for (const DriveMode mode : kDriveModes) {
    if (!modes.holds(mode)) continue;
    text += (text.empty() ? "" : ", ") + std::string(to_string(mode));
  }
  return text;
}

std::span<const DriveCausePolicy> drive_cause_policies() { return kPolicies; }

bool latches(DriveCause cause) {
  const DriveCausePolicy* policy = policy_of(cause);
  return policy && policy->latches;
}

DriveSpeed drive_speed(const DriveState& state, const DriveModeOptions& options) {
  switch (state.mode) {
    case kActive:
      return {Response::kFull, 1.0};
    case kDegraded:
    case kStopping:
    case kStopped: {  // a velocity, even zero, is for a base that does what it is told
      // A cause that has none was never entered with such a mode: the hardest answer.
      const DriveCausePolicy* policy = policy_of(state.cause);
      if (!policy) return {Response::kEmergencyStop, 0.0};
      return {policy->response, policy->share ? options.*policy->share : 0.0};
    }
    default:
      return {};
  }
}

std::span<const DriveModeRow> drive_mode_table() { return kTable; }

const DriveModeRow& deciding_row(const DriveState& before, const DriveFacts& facts,
                                 const DriveModeOptions& options) {
  for (const DriveModeRow& row : kTable) {
    if (row.from.holds(before.mode) && row.holds({before, facts, options})) return row;
  }
  return kTable[1];
}

DriveState decide(const DriveState& before, const DriveFacts& facts,
                  const DriveModeOptions& options) {
  const DriveModeRow& row = deciding_row(before, facts, options);
  return {row.to, row.cause.value_or(before.cause),
          row.to == before.mode ? before.since : facts.stamp};
}

std::string describe(const DriveState& state, const DriveFacts& facts) {
  std::string text;
  switch (state.mode) {
    case kIdle:
      text = "Stands";
      break;
    case kReady:
      text = "Stands, ready to drive";
      break;
    case kActive:
      text = "Drives";
      break;
    case kDegraded:
      text = "Drives slower";
      break;
    case kStopping:
      text = drive_speed(state, {}).response == Response::kComfortStop ? "Brakes along its way"
                                                                       : "Brakes as hard as it can";
      break;
    case kStopped:
      text = "Stands until the stop is acknowledged";
      break;
  }
  text += ": " + std::string(to_string(state.cause));
  const std::string_view name = named(state.cause, facts);
  if (!name.empty()) text += " (" + std::string(name) + ')';
  return text + '.';
}

std::string drive_mode_tables() {
  std::string text =
      "Whether the robot drives. The first row that holds is taken.\n\n"
      "| from | condition | to | cause |\n|---|---|---|---|\n";
  for (const DriveModeRow& row : kTable) {
    text += "| " + to_string(row.from) + " | " + std::string(row.condition) + " | " +
            std::string(to_string(row.to)) + " | " +
            std::string(row.cause ? to_string(*row.cause) : "as before") + " |\n";
  }
  text +=
      "\nWhat the motors get: in idle and ready zero, in active the plan's commands. In degraded, "
      "stopping and stopped the cause says it.\n\n"
      "| cause | response | share of the speed | latches |\n|---|---|---|---|\n";
  for (const DriveCausePolicy& p : kPolicies) {
    text += "| " + std::string(to_string(p.cause)) + " | " + std::string(to_string(p.response)) +
            " | " + std::string(p.share ? name_of(p.share) : "-") + " | " +
            (p.latches ? "yes" : "no") + " |\n";
  }
  return text;
}

}  // namespace prospect
