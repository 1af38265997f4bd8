// SPDX-License-Identifier: Apache-2.0
#include "runtime/command_loop.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "models/knobs.h"
#include "models/limited_twist.h"

namespace prospect {
namespace {

constexpr double kRemembered = 3.0;  // [s] of commands sent: longer than a belief may be old

bool drives(DriveResponse response) {
  return response == DriveResponse::kFull || response == DriveResponse::kSlow;
}

}  // namespace

std::string_view to_string(CommandReason reason) {
  switch (reason) {
    case CommandReason::kBase:
      return "base";
    case CommandReason::kEmergencyStop:
      return "emergency stop";
    case CommandReason::kStand:
      return "stand";
    case CommandReason::kComfortStop:
      return "comfort stop";
    case CommandReason::kObstacle:
      return "obstacle";
    case CommandReason::kNoBelief:
      return "no belief";
    case CommandReason::kNoPlan:
      return "no plan";
    case CommandReason::kGuard:
      return "guard";
    case CommandReason::kTail:
      return "tail";
    case CommandReason::kPlan:
      return "plan";
  }
  return "?";
}

std::vector<SentCommand> commands_until(const MotionModel& model, const CommandState& state,
                                        double now, double until, double period) {
  std::vector<SentCommand> commands = state.sent;
  const auto go_on = [&](const Plan* plan, const Twist& from, double begin, double end) {
    std::vector<SentCommand> more =
        commands_to_come(model, plan, state.share, from, begin, end, period);
    for (std::size_t n = 0; plan == nullptr && !state.stop.empty() && n < more.size(); ++n) {
      more[n].command = n < state.stop.size() ? state.stop[n] : Twist();
    }
    commands.insert(commands.end(), more.begin(), more.end());
    return more.empty() ? from : more.back().command;
  };
  // The next tick comes a period after the newest command, or at once.
  const double tick = state.sent.empty() ? now : std::max(now, state.sent.back().time + period);
  const double handover = state.next ? std::clamp(state.next->stamp, tick, std::max(tick, until))
                                     : std::max(tick, until);
  const Twist then = go_on(state.plan.get(), state.command, tick, handover);
  if (state.next) go_on(state.next.get(), then, handover, until);
  return commands;
}

CommandLoop::CommandLoop(std::shared_ptr<const MotionModel> model, const Guard& guard,
                         const CommandLoopOptions& options)
    : model_(std::move(model)), guard_(guard), options_(options) {
  if (!model_) throw std::invalid_argument("command loop: no motion model; expected one");
  check_knobs("command loop", options_);
}

void CommandLoop::give_up() {
  given_up_.reset();
  current_.reset();
  next_.reset();
}

void CommandLoop::adopt(const std::shared_ptr<const Plan>& plan, double now) {
  // A period that is only just begun counts: who waits for a time may wake a little early.
  constexpr double kEarly = 1e-6;
  const auto begin_next = [&] {
    if (!next_ || now + kEarly < next_->stamp) return;
    current_ = std::move(next_);
    given_up_.reset();
  };
  // Before its successor takes its place: a quick planner makes that one as soon as it has begun.
  begin_next();
  if (plan && plan != seen_) {
    seen_ = plan;
    if (now <= plan->stamp + options_.period || is_at_rest(previous_)) {
      next_ = plan;
    } else {
      ++late_plans_;
    }
  }
  begin_next();
}

void CommandLoop::stop_along(const Plan* plan, const CommandInputs& in, const Pose& pose,
                             CommandStep& step) {
  if (plan == nullptr || !in.belief || is_at_rest(previous_)) return;
  stop_ = guard_.stop_commands(plan, pose, previous_, *in.belief, options_.period);
  step.command = stop_.front();
}

void CommandLoop::drive(const CommandInputs& in, const Pose& pose, CommandStep& step) {
  if (current_->kind == PlanKind::kStoppingTail) {
    step.reason = CommandReason::kTail;
    stop_along(current_.get(), in, pose, step);
    return;
  }
  const NextCommand next =
      next_command(*model_, *current_, share_, pose, previous_, in.now, options_.period);
  TimedCommand asked;
  asked.input = next.input;
  asked.step = options_.period;
  asked.hold = options_.hold;
  asked.share = share_;
  asked.pose = pose;
  asked.following_watched = true;
  const GuardVerdict verdict = guard_.check(*current_, asked, previous_, *in.belief, in.now);
  step.command = verdict.command;
  step.guard = verdict.reason;
  step.detail = verdict.detail;
  if (!verdict.passed()) {
    step.reason = CommandReason::kGuard;
    const std::shared_ptr<const Plan> refused = current_;
    give_up();
    if (follows_plan(verdict.reason)) {
      given_up_ = refused;
      stop_along(given_up_.get(), in, pose, step);
    }
    return;
  }
  step.reason = current_->phase_at(in.now) == PlanPhase::kCommitted ? CommandReason::kPlan
                                                                    : CommandReason::kTail;
}

CommandStep CommandLoop::step(const CommandInputs& in) {
  adopt(in.plan, in.now);
  CommandStep step;
  step.expires = in.now + options_.hold;
  Pose pose;
  if (in.belief) {
    const std::vector<SentCommand> sent(sent_.begin(), sent_.end());
    pose = predicted_pose(in.belief->pose, in.belief->stamp, sent,
                          std::max(in.now, in.belief->stamp), options_.delay);
  }
  share_ = drives(in.drive.response)
               ? std::clamp(std::min(in.drive.share, in.range_share), 0.0, 1.0)
               : 0.0;
  step.command = braking_command(*model_, pose, previous_, options_.period).command;
  stop_.clear();
  if (!in.base.connected) {
    step.reason = CommandReason::kBase;
    step.detail = "the base is not connected";
    step.stop = true;
  } else if (!in.base.faults.empty()) {
    step.reason = CommandReason::kBase;
    step.detail = "the base reports: " + in.base.faults.front();
    step.stop = true;
  } else if (in.drive.response == DriveResponse::kEmergencyStop) {
    step.reason = CommandReason::kEmergencyStop;
    step.stop = true;
  } else if (in.drive.response == DriveResponse::kStand) {
    step.reason = CommandReason::kStand;
    // It is at rest, however it came to it: a ramp from the last command would set it in motion.
    step.command = Twist();
  } else if (!drives(in.drive.response)) {
    step.reason = CommandReason::kComfortStop;
    stop_along(current_ ? current_.get() : given_up_.get(), in, pose, step);
  } else if (!(share_ > 0.0)) {
    step.reason = CommandReason::kObstacle;
    step.detail = "ranges show something on the way that leaves no room to go on";
  } else if (!in.belief) {
    step.reason = CommandReason::kNoBelief;
    step.detail = "nothing is known of where the robot is";
  } else if (!current_) {
    step.reason = CommandReason::kNoPlan;
    stop_along(given_up_.get(), in, pose, step);
  } else {
    drive(in, pose, step);
  }
  previous_ = step.command;
  sent_.push_back({in.now, step.command});
  while (sent_.size() > 1 && sent_[1].time < in.now - kRemembered) sent_.pop_front();
  return step;
}

CommandState CommandLoop::state() const {
  CommandState state;
  state.sent.assign(sent_.begin(), sent_.end());
  state.command = previous_;
  // Where it does not drive, no plan is in force.
  if (share_ > 0.0) {
    state.plan = stop_.empty() ? current_ : nullptr;
    state.next = next_;
  }
  if (!stop_.empty()) state.stop.assign(stop_.begin() + 1, stop_.end());
  state.share = share_;
  return state;
}

}  // namespace prospect
