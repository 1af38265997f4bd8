#include "runtime/preflight_run.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <utility>

#include "models/tracking_input.h"
#include "models/knobs.h"
#include "models/limited_twist.h"
#include "runtime/next_command.h"
#include "runtime/stream_watch.h"

namespace prospect {
namespace {

/// Turning to the left by an angle from rest, as a plan: the guard judges each command of it.
/// None: the model cannot.
std::optional<Plan> turning_plan(const MotionModel& model, const Pose& pose, double stamp,
                                 double angle, double rate) {
  constexpr double kStep = 0.1;  // [s]
  Plan plan;
  plan.kind = PlanKind::kSeed;
  plan.stamp = stamp;
  plan.dt = kStep;
  plan.certified = true;
  const Twist wanted{Eigen::Vector3d::Zero(), rate};
  Twist before;
  Eigen::VectorXd x = model.state(pose, before), next(model.nx());
  plan.states.push_back(x);
  const int most = static_cast<int>(std::ceil(4.0 * angle / (rate * kStep))) + 10;
  for (double turned = 0.0; turned < angle - 1e-9; turned += before.yaw_rate * kStep) {
    if (static_cast<int>(plan.inputs.size()) == most) return std::nullopt;
    Eigen::VectorXd input = tracking_input(model, x, model.input(before), wanted, kStep);
    model.step(x, input, kStep, next);
    x = next;
    before = model.twist(x, input);
    plan.inputs.push_back(std::move(input));
    plan.states.push_back(x);
    plan.commands.push_back(before);
  }
  plan.committed = static_cast<int>(plan.commands.size());
  // Braking adds to the angle: a base that starts more slowly than it stops loses less of it so.
  for (int k = 0; k < most && !is_at_rest(before); ++k) {
    before = braking_command(model, pose, before, kStep).command;
    plan.tail.push_back(before);
  }
  return plan;
}

class Run {
 public:
  Run(const PreflightParts& parts, const PreflightRunOptions& options,
      const CommandLoopOptions& command, const std::function<bool()>& cancelled)
      : parts_(parts), options_(options), command_(command), cancelled_(cancelled) {}

  PreflightResult make() {
    const std::jthread perceives([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (auto newest = parts_.beliefs.update(stop)) {
          const std::lock_guard lock(mutex_);
          belief_ = std::move(newest);
        }
      }
    });
    PreflightResult result;
    PreflightFacts facts = parts_.known;
    watch(facts);
    if (parts_.floor) facts.floor = parts_.floor();
    facts.dead_man = parts_.base.dead_man();
    facts.command_period = command_.period;
    const BaseLimits limits = parts_.base.limits();
    facts.speed = {limits.speed, parts_.model->max_speed()};
    facts.yaw_rate = {limits.yaw_rate, parts_.model->max_yaw_rate()};
    facts.deceleration = {limits.acceleration, parts_.model->max_deceleration()};
    result.checks = checks_before_motion(facts, options_.checks);

    YawTurn made;
    std::string hindered = "not asked for";
    if (!first_failed(result.checks).empty()) {
      hindered = "a check before it has failed";
    } else if (options_.turn > 0.0) {
      hindered = turn(made);
    }
    for (CheckResult& check : checks_of_turn(made, options_.checks)) {
      if (!hindered.empty())
        check = {check.check, CheckVerdict::kNotPossible, "no turn: " + hindered};
      result.checks.push_back(std::move(check));
    }
    result.yaw_checked = hindered.empty() && (made.wheels || made.cameras);
    if (is_cancelled()) {
      result.checks.push_back({"checks", CheckVerdict::kFailed, "they were cancelled"});
    }
    parts_.base.stop();
    return result;
  }

 private:
  bool is_cancelled() const { return cancelled_ && cancelled_(); }
  std::shared_ptr<const Belief> newest() {
    const std::lock_guard lock(mutex_);
    return belief_;
  }

  /// What the base has measured since the call before goes to the inbox.
  BaseReport report() {
    BaseReport report = parts_.base.report();
    if (parts_.inbox) {
      for (const WheelSample& sample : report.wheels) parts_.inbox->wheels(sample);
    }
    return report;
  }
  void wait() { parts_.clock.wait_until(parts_.clock.now() + command_.period, {}); }

  /// The robot stands while its streams come.
  void watch(PreflightFacts& facts) {
    std::vector<PreflightFacts::Stream> all;
    for (const WatchedStream& s : parts_.streams) all.push_back({s.source, 0.0, s.limit, 0.0});
    StreamWatch watch(std::move(all), parts_.clock.now());
    const double end = parts_.clock.now() + options_.patience;
    for (;;) {
      report();
      const std::shared_ptr<const Belief> belief = newest();
      const double now = parts_.clock.now();
      for (std::size_t k = 0; k < parts_.streams.size(); ++k) {
        watch.look(k, parts_.streams[k].stamp(belief.get()), now);
      }
      const bool located = belief && belief->localization != Localization::kLost;
      if ((located && watch.live_for(options_.checks.live_time)) || now >= end || is_cancelled()) {
        break;
      }
      parts_.base.send({}, now + command_.hold);
      wait();
    }
    facts.streams = watch.streams();
    for (const WatchedStream& s : parts_.streams) {
      PreflightFacts::Clock clock{s.source, 0.0, 0};
      if (s.count) {
        const StreamCount count = s.count();
        clock.offset = count.offset;
        clock.jumps = count.jumps;
      }
      facts.clocks.push_back(clock);
    }
    if (parts_.inbox && !facts.stereo_offset) facts.stereo_offset = parts_.inbox->pair_offset();
  }

  /// Turns, and notes what came of it; why not, if it cannot.
  std::string turn(YawTurn& made) {
    const std::shared_ptr<const Belief> before = newest();
    if (!before || before->localization == Localization::kLost) return "localization is lost";
    const double rate = std::min(options_.turn_rate, 0.5 * parts_.model->max_yaw_rate());
    if (!(rate > 0.0)) return "the model does not turn on the spot";
    const std::optional<Plan> plan = turning_plan(
        *parts_.model, before->pose, parts_.clock.now() + command_.period, options_.turn, rate);
    if (!plan) return "the model does not turn on the spot";
    const auto shared = std::make_shared<const Plan>(*plan);
    const double end =
        plan->stamp + plan->dt * static_cast<double>(plan->commands.size() + plan->tail.size());
    CommandLoop loop(parts_.model, parts_.guard, command_);
    std::string hindered;
    double wheels = 0.0, stamp = 0.0, last = parts_.clock.now();
    Twist in_force;
    bool by_wheels = false;
    for (;;) {
      const BaseReport told = report();
      const double now = parts_.clock.now();
      made.commanded += in_force.yaw_rate * (now - last);
      for (const WheelSample& sample : told.wheels) {
        if (by_wheels) wheels += sample.yaw_rate * (sample.stamp - stamp);
        by_wheels = true;
        stamp = sample.stamp;
      }
      if (!by_wheels) wheels += told.velocity.yaw_rate * (now - last);
      last = now;
      if (now >= end + options_.settle) break;
      if (is_cancelled()) return "it was cancelled";
      if (parts_.requests &&
          (!parts_.requests->told_to_drive() || parts_.requests->emergency_stop_waits())) {
        return "it was told to stand";
      }
      const RangeLook look = parts_.ranges ? parts_.ranges(in_force, now) : RangeLook();
      const CommandStep step = loop.step(
          {now, shared, newest(), told, DriveSpeed{DriveResponse::kFull, 1.0}, look.share});
      in_force = step.command;
      if (step.stop) {
        parts_.base.stop();
      } else {
        parts_.base.send(step.command, step.expires);
      }
      if (hindered.empty() && !step.detail.empty()) {
        hindered = look.obstacle.empty() ? step.detail : look.obstacle;
      }
      if (step.reason == CommandReason::kBase) return hindered;
      wait();
    }
    made.wheels = wheels;
    const std::shared_ptr<const Belief> after = newest();
    if (after->localization != Localization::kLost) {
      made.cameras = std::remainder(after->pose.yaw - before->pose.yaw, 2.0 * M_PI);
    }
    return hindered;
  }

  const PreflightParts& parts_;
  const PreflightRunOptions& options_;
  const CommandLoopOptions& command_;
  const std::function<bool()>& cancelled_;
  std::mutex mutex_;
  std::shared_ptr<const Belief> belief_;
};

}  // namespace

PreflightResult run_preflight(const PreflightParts& parts, const PreflightRunOptions& options,
                              const CommandLoopOptions& command,
                              const std::function<bool()>& cancelled) {
  check_knobs("preflight", options);
  check_knobs("command loop", command);
  if (!parts.model) throw std::invalid_argument("preflight: no motion model; expected one");
  return Run(parts, options, command, cancelled).make();
}

}  // namespace prospect
