#include "runtime/mission_progress.h"

#include <utility>

namespace prospect {
namespace {

MissionEnd end_for(Cause cause) {
  switch (cause) {
    case Cause::kUnreachable:
      return MissionEnd::kUnreachable;
    case Cause::kYieldTooLow:
      return MissionEnd::kYieldTooLow;
    case Cause::kGoalReached:
      return MissionEnd::kGoalReached;
    case Cause::kReturned:
      return MissionEnd::kReturned;
    case Cause::kGoalUnreachable:
      return MissionEnd::kGoalUnreachable;
    default:
      return MissionEnd::kExplored;
  }
}

}  // namespace

MissionProgress::MissionProgress(const MissionOptions& options, double start)
    : options_(options), start_(start), last_localized_(start) {}

// On the way back `end` stays that of the task.
bool MissionProgress::over(MissionEnd end, const std::string& detail) {
  if (!result.back) {
    result.end = end;
    result.detail = detail;
  } else if (end == MissionEnd::kReturned) {
    result.back = true;
    result.detail += " It is back where it began.";
  } else {
    result.detail += " It did not get back: " + detail;
  }
  return true;
}

bool MissionProgress::over_before(const Belief& belief, double now, bool cancelled) {
  result.duration = now - start_;
  if (cancelled) {
    return over(MissionEnd::kCancelled,
                "cancelled after " + std::to_string(result.duration) + " s");
  }
  if (result.duration >= options_.time_limit) {
    return over(MissionEnd::kTimeLimit,
                "the time limit of " + std::to_string(options_.time_limit) + " s is reached");
  }
  if (belief.localization != Localization::kLost) {
    last_localized_ = now;
  } else if (now - last_localized_ > options_.lost_limit) {
    return over(MissionEnd::kLost, "localization was lost and did not come back within " +
                                       std::to_string(options_.lost_limit) + " s");
  }
  return false;
}

bool MissionProgress::over_after(const MissionStep& step, Replanner& planner) {
  const Plan& plan = *step.plan;
  ++result.steps;
  if (plan.kind == PlanKind::kStoppingTail) ++result.fallbacks;
  if (plan.fault == PlanFault::kMisfit) return over(MissionEnd::kNotFit, plan.detail);
  const bool done = plan.mode.kind == ModeKind::kDone;
  if (done && detour_) {
    detour_->hold();
    detour_->tell(plan.why);
    detour_ = nullptr;
    planner.set_task(result.back ? Task::return_to_start() : options_.task);
    return false;
  }
  if (!done && (result.back || !options_.enough || !options_.enough(step))) return false;
  const MissionEnd end = done ? end_for(plan.mode.cause) : MissionEnd::kEnough;
  over(end, done ? plan.why : "enough was seen.");
  if (result.back || !options_.return_when_done || end == MissionEnd::kReturned) return true;
  result.back = false;
  const std::string refused = planner.set_task(Task::return_to_start());
  return !refused.empty() && over(MissionEnd::kGoalUnreachable, refused);
}

void MissionProgress::take_detour(DriveRequests& requests, Replanner& planner) {
  const std::optional<Eigen::Vector2d> place = requests.take_place();
  if (!place) return;
  std::string refused = planner.set_task(Task::go_to(*place));
  if (refused.empty()) {
    detour_ = &requests;
    requests.resume();
  } else {
    requests.tell(std::move(refused));
  }
}

}  // namespace prospect
