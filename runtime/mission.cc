// SPDX-License-Identifier: Apache-2.0
#include "runtime/mission.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "runtime/drive_mode.h"
#include "runtime/mission_progress.h"

namespace prospect {
namespace {

/// What the robot is doing.
struct InForce {
  Twist command;
  std::shared_ptr<const Plan> plan{};  ///< that it is of; null: none yet
  DriveState mode{DriveMode::kActive};
};

bool is_zero(const Twist& twist) { return twist.linear.isZero(0.0) && twist.yaw_rate == 0.0; }

void apply(LockstepRobot& robot, const MissionOptions& options, const Twist& command,
           double duration) {
  if (duration > 0.0) tell(options.observers, &MissionObserver::on_command, robot.time(), command);
  robot.apply(command, duration);
}

/// Brakes until the robot stands, along the path of the last plan where that is free. So rates are
/// kept, and a source that has died does not keep it from braking.
void bring_to_rest(LockstepRobot& robot, const Guard& guard, const MissionOptions& options,
                   InForce& in_force) {
  constexpr int kMost = 100;  // of a base that does not come to rest in that many no more is known
  constexpr double kStep = 0.25;  // [s]
  Twist& command = in_force.command;
  for (int n = 0; n < kMost; ++n) {
    const std::shared_ptr<const Belief> belief = robot.sense();
    command =
        guard.stop_commands(in_force.plan.get(), belief->pose, command, *belief, kStep).front();
    apply(robot, options, command, is_zero(command) ? 0.0 : kStep);
    if (is_zero(command) || !robot.fault().empty()) return;
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
bool wait_for(LockstepRobot& robot, const Guard& guard, const MissionOptions& options,
              DriveRequests& requests, MissionProgress& progress, InForce& in_force) {
  DriveState& mode = in_force.mode;
  for (;;) {
    mode = decide(mode, asked(requests, robot.time(), is_zero(in_force.command)), {});
    if (mode.mode == DriveMode::kStopping) bring_to_rest(robot, guard, options, in_force);
    requests.set_stopped(mode.mode == DriveMode::kStopped);
    progress.take_detour(requests);
    if (options.cancelled && options.cancelled()) return true;
    if (mode.mode == DriveMode::kActive) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// The mission up to its last stop; `in_force` holds also when an observer throws.
MissionResult explore(LockstepRobot& robot, Replanner& planner, const Guard& guard,
                      const MissionOptions& options, DriveRequests* requests, InForce& in_force) {
  Twist& previous = in_force.command;
  MissionProgress progress(options, planner, robot.time());
  GuardStops stops;
  while (true) {
    const bool is_cancelled = requests
                                  ? wait_for(robot, guard, options, *requests, progress, in_force)
                                  : options.cancelled && options.cancelled();
    const std::shared_ptr<const Belief> belief = robot.sense();
    if (const std::string fault = robot.fault(); !fault.empty()) {
      progress.result.end = MissionEnd::kRobotLost;
      progress.result.detail = fault;
      return progress.result;
    }
    if (progress.over_before(*belief, robot.time(), is_cancelled)) return progress.result;
    if (!options.observers.empty()) {
      if (const CameraPicture picture = robot.picture(); picture.image) {
        tell(options.observers, &MissionObserver::on_picture, picture);
      }
    }
    tell(options.observers, &MissionObserver::on_belief, *belief);

    Belief commanded = *belief;
    commanded.command = previous;
    const std::shared_ptr<const Plan> plan = progress.plan(*belief, commanded, robot.time());
    if (!plan || progress.over_after(*belief, *plan, std::exchange(stops, {}))) {
      return progress.result;
    }

    const int stages =
        std::max(1, std::min<int>(plan->committed, static_cast<int>(plan->commands.size())));
    in_force.plan = plan;
    for (int stage = 0; stage < stages; ++stage) {
      const GuardVerdict verdict =
          guard.check(*plan, stage, previous, *robot.sense(), robot.time());
      apply(robot, options, verdict.command, verdict.duration);
      previous = verdict.command;
      if (verdict.passed()) continue;
      ++stops.count;
      stops.reason = verdict.reason;
      ++progress.result.guard_stops;
      break;
    }
  }
}

}  // namespace

MissionResult run_mission(LockstepRobot& robot, Replanner& planner, const Guard& guard,
                          const MissionOptions& options, DriveRequests* requests) {
  InForce in_force{robot.sense()->twist};
  MissionResult result;
  try {
    result = explore(robot, planner, guard, options, requests, in_force);
  } catch (...) {
    bring_to_rest(robot, guard, options, in_force);
    throw;
  }
  bring_to_rest(robot, guard, options, in_force);
  tell(options.observers, &MissionObserver::on_end, result);
  return result;
}

}  // namespace prospect
