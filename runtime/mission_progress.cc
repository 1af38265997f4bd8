// SPDX-License-Identifier: Apache-2.0
#include "runtime/mission_progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "runtime/truth.h"

namespace prospect {
namespace {

std::string text(const char* format, double a, double b = 0.0, double c = 0.0, double d = 0.0) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, a, b, c, d);
  return buffer;
}

}  // namespace

MissionProgress::MissionProgress(const MissionOptions& options, Replanner& planner, double start)
    : options_(options), planner_(planner), start_(start), last_localized_(start) {}

// On the path back `end` stays that of the task.
bool MissionProgress::over(MissionEnd end, std::string detail) {
  if (result.back) {
    if (end == MissionEnd::kReturned) {
      result.back = true;
      result.detail += " It is back where it began.";
      if (result.heading_missed) result.detail += ' ' + detail;
    } else {
      result.detail += " It did not get back: " + detail;
    }
    return true;
  }
  const bool done = row_of(end).outcome == Outcome::kDone;
  if (!done && !missing_.empty()) detail += " Less was seen than asked for: " + missing_ + '.';
  const bool told = detail.find(refused_) != std::string::npos;  // by the planner
  if (!done && began_at_ && strayed_ < kMoved && !told) {
    detail +=
        " It has not moved: the certificate refused what it would have driven (" + refused_ + ").";
  }
  result.end = end;
  result.detail = std::move(detail);
  return true;
}

bool MissionProgress::over_before(const Belief& belief, double now, bool cancelled) {
  result.duration = now - start_;
  if (options_.truth != nullptr) {
    const TrueState truth = options_.truth->newest();
    if (truth.fallen) {
      // Also on the way back: whatever was done before.
      result.end = MissionEnd::kFallen;
      result.detail = text("it fell where there is no floor, at (%.2f, %.2f) m.",
                           truth.pose.position.x(), truth.pose.position.y());
      return true;
    }
  }
  if (cancelled) {
    return over(MissionEnd::kCancelled, text("cancelled after %.1f s.", result.duration));
  }
  if (result.duration >= options_.time_limit) {
    return over(MissionEnd::kTimeLimit,
                text("the time limit of %g s is reached.", options_.time_limit));
  }
  if (belief.localization != Localization::kLost) {
    last_localized_ = now;
  } else if (now - last_localized_ > options_.lost_limit) {
    return over(MissionEnd::kLost, text("localization was lost and did not come back within %g s.",
                                        options_.lost_limit));
  }
  return false;
}

void MissionProgress::prepare(const Belief& belief) {
  tell(options_.observers, &MissionObserver::on_prepare, belief);
  planner_.prepare(belief);
}

std::shared_ptr<const Plan> MissionProgress::plan(const Belief& newest, const Belief& from,
                                                  double now) {
  tell(options_.observers, &MissionObserver::on_plan, from);
  const auto plan = std::make_shared<Plan>(planner_.plan(from));
  if (plan->stop == StopReason::kCancelled) {
    over_before(newest, now, true);
    return nullptr;
  }
  tell(options_.observers, &MissionObserver::on_planned, *plan);
  // It begins when it was meant to, whatever the planner made of the stamp.
  plan->stamp = from.stamp;
  return plan;
}

bool MissionProgress::over_after(const Belief& newest, const Plan& plan, const GuardStops& stops) {
  const std::shared_ptr<const GlobalPlan> global_plan = planner_.global_plan();
  MissionStep step{result.steps,      result.duration, &newest,      &plan,
                   global_plan.get(), stops.count,     stops.reason, planner_.step()};
  if (options_.truth) step.truth = options_.truth->at(newest);
  tell(options_.observers, &MissionObserver::on_step, step);
  ++result.steps;
  if (plan.kind == PlanKind::kStoppingTail) ++result.fallbacks;
  const Eigen::Vector2d at = step.belief->pose.position.head<2>();
  if (!began_at_) began_at_ = at;
  strayed_ = std::max(strayed_, (at - *began_at_).norm());
  if (!plan.refused.empty()) refused_ = plan.refused;
  if (plan.fault == PlanFault::kMisfit) return over(MissionEnd::kNotFit, plan.detail);
  const bool done = plan.mode.kind == ModeKind::kDone;
  if (done && detour_) {
    const bool there = row_of(end_for(plan.mode.cause)).outcome == Outcome::kDone;
    end_detour(there ? DetourState::kThere : DetourState::kNotThere, plan.why);
    return false;
  }
  const bool asked = options_.missing && !result.back;
  if (asked) missing_ = options_.missing(step);
  const bool enough = asked && missing_.empty();
  if (!done && !enough) {
    return options_.return_when_done && !result.back && turned_back(step);
  }
  MissionEnd end = done ? end_for(plan.mode.cause) : MissionEnd::kEnough;
  if (done) result.heading_missed = plan.heading_missed;
  const bool explored = end == MissionEnd::kExplored || end == MissionEnd::kYieldTooLow;
  if (explored && !missing_.empty()) end = MissionEnd::kTooLittle;
  over(end, done ? plan.why : "enough was seen.");
  if (result.back || !options_.return_when_done || end == MissionEnd::kReturned) return true;
  return begin_return();
}

std::string MissionProgress::set_task(const Task& task) {
  tell(options_.observers, &MissionObserver::on_task, task);
  return planner_.set_task(task);
}

// Whether it is over, because the planner cannot return.
bool MissionProgress::begin_return() {
  result.back = false;
  if (detour_) {
    detour_->tell({place_, DetourState::kNotThere, "it is on the way back to where it began"});
  }
  detour_ = nullptr;
  const std::string refused = set_task(Task::return_to_start());
  return !refused.empty() && over(MissionEnd::kGoalUnreachable, refused);
}

// Turns back if it is time to; whether it is over then.
bool MissionProgress::turned_back(const MissionStep& step) {
  const double elapsed = result.duration;
  if (elapsed < ask_return_path_at_) return false;
  const std::optional<ReturnPath> path = planner_.return_path(*step.belief);
  if (!path) return false;
  const double spare = options_.time_limit - elapsed - path->time;
  ask_return_path_at_ = elapsed + std::min(kAskEvery, spare / 3.0);
  // A step later there might not be enough.
  const double step_time = std::max(1, step.plan->committed) * step.plan->dt;
  if (spare > step_time) return false;
  over(MissionEnd::kTimeLimit,
       text("turned back after %.0f s: the way of %.1f m to where it began takes about %.0f s of "
            "the time limit of %g s.",
            elapsed, path->length, path->time, options_.time_limit));
  result.turned_back_at = elapsed;
  return begin_return();
}

void MissionProgress::take_detour(DriveRequests& requests) {
  const bool cancelled = requests.take_cancellation();
  if (const auto place = requests.take_place()) {
    std::string refused = set_task(Task::go_to(place->position, place->yaw));
    if (refused.empty()) {
      detour_ = &requests;
      place_ = place->number;
      requests.tell({place_, DetourState::kOnTheWay, ""});
      requests.resume();
    } else {
      requests.tell({place->number, DetourState::kRefused, std::move(refused)});
    }
  } else if (cancelled && detour_) {
    end_detour(DetourState::kCancelled, "cancelled");
  }
}

void MissionProgress::end_detour(DetourState state, const std::string& why) {
  detour_->hold();
  detour_->tell({place_, state, why});
  detour_ = nullptr;
  set_task(result.back ? Task::return_to_start() : options_.task);
}

}  // namespace prospect
