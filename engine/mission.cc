#include "engine/mission.h"

#include <algorithm>
#include <cmath>

namespace prospect {
namespace {

/// Brings the robot to rest when the mission ends, however it ends.
class StopAtEnd {
 public:
  explicit StopAtEnd(Robot& robot) : robot_(robot) {}
  ~StopAtEnd() { robot_.apply(Twist{}, 0.0); }
  StopAtEnd(const StopAtEnd&) = delete;
  StopAtEnd& operator=(const StopAtEnd&) = delete;

 private:
  Robot& robot_;
};

}  // namespace

std::string_view to_string(MissionEnd end) {
  switch (end) {
    case MissionEnd::kExplored:
      return "explored";
    case MissionEnd::kYieldTooLow:
      return "yield too low";
    case MissionEnd::kUnreachable:
      return "unreachable";
    case MissionEnd::kTimeLimit:
      return "time limit";
    case MissionEnd::kLost:
      return "localization lost";
    case MissionEnd::kCancelled:
      return "cancelled";
  }
  return "?";
}

MissionResult run_mission(Robot& robot, Replanner& planner, const Guard& guard,
                          const MissionOptions& options,
                          const std::function<void(const MissionStep&)>& observe,
                          const std::function<bool()>& cancelled) {
  const StopAtEnd stop_at_end(robot);
  MissionResult result;
  const double start = robot.time();
  Twist previous = robot.sense()->twist;
  double last_localized = start;
  int guard_stops = 0;
  GuardReason guard_reason = GuardReason::kPassed;
  while (true) {
    const std::shared_ptr<const Belief> belief = robot.sense();
    result.duration = robot.time() - start;
    if (cancelled && cancelled()) {
      result.end = MissionEnd::kCancelled;
      result.detail = "cancelled after " + std::to_string(result.duration) + " s";
      return result;
    }
    if (result.duration >= options.time_limit) {
      result.end = MissionEnd::kTimeLimit;
      result.detail = "the time limit of " + std::to_string(options.time_limit) + " s is reached";
      return result;
    }
    if (belief->localization != Localization::kLost) {
      last_localized = robot.time();
    } else if (robot.time() - last_localized > options.lost_limit) {
      result.end = MissionEnd::kLost;
      result.detail = "localization was lost and did not come back within " +
                      std::to_string(options.lost_limit) + " s";
      return result;
    }

    Belief commanded = *belief;
    commanded.command = previous;
    const Plan plan = planner.plan(commanded);
    const std::shared_ptr<const Guidance> guidance = planner.guidance();
    if (observe) {
      observe({result.steps, result.duration, belief.get(), &plan, guidance.get(), guard_stops,
               guard_reason});
    }
    ++result.steps;
    guard_stops = 0;
    guard_reason = GuardReason::kPassed;
    if (plan.kind == PlanKind::kStoppingTail) ++result.fallbacks;
    if (plan.mode.kind == ModeKind::kDone) {
      result.end = plan.mode.cause == Cause::kUnreachable   ? MissionEnd::kUnreachable
                   : plan.mode.cause == Cause::kYieldTooLow ? MissionEnd::kYieldTooLow
                                                            : MissionEnd::kExplored;
      result.detail = plan.why;
      return result;
    }

    const int stages =
        std::max(1, std::min<int>(plan.committed, static_cast<int>(plan.commands.size())));
    // A plan without a duration must not hold the clock still.
    const bool lasts = std::isfinite(plan.dt) && plan.dt > 0.0;
    const double dt = lasts ? plan.dt : Plan().dt;
    for (int stage = 0; stage < stages; ++stage) {
      const GuardVerdict verdict = guard.check(plan, stage, previous, *robot.sense(), robot.time());
      robot.apply(verdict.command, dt);
      previous = verdict.command;
      if (verdict.passed()) continue;
      ++guard_stops;
      guard_reason = verdict.reason;
      ++result.guard_stops;
      break;
    }
  }
}

}  // namespace prospect
