#include "runtime/mission.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <thread>

#include "runtime/drive_mode.h"
#include "runtime/mission_progress.h"

namespace prospect {
namespace {

/// What the robot is doing.
struct InForce {
  Twist command;
  Plan plan{};  ///< that it is of
  DriveState mode{DriveMode::kActive};
};

bool is_zero(const Twist& twist) { return twist.linear.isZero(0.0) && twist.yaw_rate == 0.0; }

/// Brakes until the robot stands, along the path of the last plan where that is free. So rates are
/// kept, and a source that has died does not keep it from braking.
void bring_to_rest(Robot& robot, const Guard& guard, InForce& in_force) {
  constexpr int kMost = 100;  // of a base that does not come to rest in that many no more is known
  constexpr double kStep = 0.25;  // [s]
  Twist& command = in_force.command;
  for (int n = 0; n < kMost; ++n) {
    const std::shared_ptr<const Belief> belief = robot.sense();
    command = guard.stop_commands(&in_force.plan, belief->pose, command, *belief, kStep).front();
    robot.apply(command, is_zero(command) ? 0.0 : kStep);
    if (is_zero(command)) return;
  }
}

/// What people ask for, as facts for the table of drive modes: in lockstep nothing else is amiss.
DriveFacts asked(DriveRequests& requests, double now, bool at_rest) {
  constexpr double kEver = std::numeric_limits<double>::infinity();
  DriveFacts facts;
  facts.stamp = now;
  facts.told_to_drive = requests.told_to_drive();
  facts.emergency_stop = requests.take_emergency_stop();
  facts.acknowledged = requests.take_acknowledgement();
  facts.rest_for = at_rest ? kEver : 0.0;
  facts.silent_emergency_stop.clear();
  facts.failed_preflight.clear();
  facts.base_silent = false;
  facts.yaw_checked = true;
  facts.live_for = facts.localized_for = facts.plan_left = kEver;
  facts.plan_from_rest = kEver;
  facts.localization = Localization::kOk;
  return facts;
}

/// Brakes where people want it to, and stands for as long. Returns whether the mission is cancelled
/// meanwhile.
bool wait_for(Robot& robot, const Guard& guard, Replanner& planner, DriveRequests& requests,
              MissionProgress& progress, const std::function<bool()>& cancelled,
              InForce& in_force) {
  DriveState& mode = in_force.mode;
  for (;;) {
    mode = decide(mode, asked(requests, robot.time(), is_zero(in_force.command)), {});
    if (mode.mode == DriveMode::kStopping) bring_to_rest(robot, guard, in_force);
    requests.set_stopped(mode.mode == DriveMode::kStopped);
    progress.take_detour(requests, planner);
    if (cancelled && cancelled()) return true;
    if (mode.mode == DriveMode::kActive) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// Who is told of a mission's steps, and who may end it or make it wait.
struct Callers {
  const std::function<void(const MissionStep&)>& observe;
  const std::function<bool()>& cancelled;
  DriveRequests* requests;
};

/// The mission up to its last stop; `in_force` holds also when `observe` throws.
MissionResult explore(Robot& robot, Replanner& planner, const Guard& guard,
                      const MissionOptions& options, const Callers& callers, InForce& in_force) {
  const auto& [observe, cancelled, requests] = callers;
  Twist& previous = in_force.command;
  MissionProgress progress(options, robot.time());
  MissionResult& result = progress.result;
  int guard_stops = 0;
  GuardReason guard_reason = GuardReason::kPassed;
  while (true) {
    const bool is_cancelled =
        requests ? wait_for(robot, guard, planner, *requests, progress, cancelled, in_force)
                 : cancelled && cancelled();
    const std::shared_ptr<const Belief> belief = robot.sense();
    if (progress.over_before(*belief, robot.time(), is_cancelled)) return result;

    Belief commanded = *belief;
    commanded.command = previous;
    const Plan plan = planner.plan(commanded);
    // What was cut short is no step.
    if (plan.stop == StopReason::kCancelled && progress.over_before(*belief, robot.time(), true)) {
      return result;
    }
    const std::shared_ptr<const GlobalPlan> global_plan = planner.global_plan();
    const MissionStep step{result.steps,      result.duration, belief.get(), &plan,
                           global_plan.get(), guard_stops,     guard_reason};
    if (observe) observe(step);
    guard_stops = 0;
    guard_reason = GuardReason::kPassed;
    if (progress.over_after(step, planner)) return result;

    const int stages =
        std::max(1, std::min<int>(plan.committed, static_cast<int>(plan.commands.size())));
    in_force.plan = plan;
    for (int stage = 0; stage < stages; ++stage) {
      const GuardVerdict verdict = guard.check(plan, stage, previous, *robot.sense(), robot.time());
      robot.apply(verdict.command, verdict.duration);
      previous = verdict.command;
      if (verdict.passed()) continue;
      ++guard_stops;
      guard_reason = verdict.reason;
      ++result.guard_stops;
      break;
    }
  }
}

}  // namespace

MissionResult run_mission(Robot& robot, Replanner& planner, const Guard& guard,
                          const MissionOptions& options,
                          const std::function<void(const MissionStep&)>& observe,
                          const std::function<bool()>& cancelled, DriveRequests* requests) {
  InForce in_force{robot.sense()->twist};
  MissionResult result;
  try {
    result = explore(robot, planner, guard, options, {observe, cancelled, requests}, in_force);
  } catch (...) {
    bring_to_rest(robot, guard, in_force);
    throw;
  }
  bring_to_rest(robot, guard, in_force);
  return result;
}

}  // namespace prospect
