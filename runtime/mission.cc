#include "runtime/mission.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "runtime/mission_progress.h"

namespace prospect {
namespace {

/// What the robot is doing.
struct InForce {
  Twist command;
  Plan plan;  ///< that it is of
};

/// Brakes until the robot stands, along the path of the last plan where that is free. So rates are
/// kept, and a source that has died does not keep it from braking.
void bring_to_rest(Robot& robot, const Guard& guard, const InForce& in_force) {
  constexpr int kMost = 100;  // of a base that does not come to rest in that many no more is known
  constexpr double kStep = 0.25;  // [s]
  Twist previous = in_force.command;
  for (int n = 0; n < kMost; ++n) {
    const std::shared_ptr<const Belief> belief = robot.sense();
    previous = guard.stop_commands(&in_force.plan, belief->pose, previous, *belief, kStep).front();
    const bool at_rest = previous.linear.isZero(0.0) && previous.yaw_rate == 0.0;
    robot.apply(previous, at_rest ? 0.0 : kStep);
    if (at_rest) return;
  }
}

/// Waits as long as people want it to. Returns whether the mission is cancelled meanwhile.
bool wait_for(DriveRequests& requests, MissionProgress& progress, Replanner& planner,
              const std::function<bool()>& cancelled) {
  for (;;) {
    if (requests.take_emergency_stop()) requests.set_stopped(true);
    if (requests.take_acknowledgement()) requests.set_stopped(false);
    progress.take_detour(requests, planner);
    if (cancelled && cancelled()) return true;
    if (requests.told_to_drive() && !requests.stopped()) return false;
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
        requests ? wait_for(*requests, progress, planner, cancelled) : cancelled && cancelled();
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
  InForce in_force{robot.sense()->twist, {}};
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
