// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/guard.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <stdexcept>
#include <utility>

#include "engine/safety/stop.h"
#include "models/knobs.h"
#include "models/limited_twist.h"

namespace prospect {
namespace {

/// Largest change of the j-th velocity per second: the rate limit of an input that is a velocity,
/// the bounds of one that is an acceleration.
double largest_acceleration(const MotionModel& model, int j) {
  const InputLimits& limits = model.limits();
  if (std::isfinite(limits.rate[j])) return limits.rate[j];
  if (model.num_state_constraints() == 0) return std::numeric_limits<double>::infinity();
  return std::max(std::abs(limits.lower[j]), std::abs(limits.upper[j]));
}

bool is_finite(const Pose& pose) { return pose.position.allFinite() && std::isfinite(pose.yaw); }

constexpr double kStepRounding = 1e-9;  // of a quotient of times
constexpr double kFuture = 1e-6;        // [s] that a stamp may be ahead of the clock: rounding

GuardReason reason_of(Certificate::Status status) {
  switch (status) {
    case Certificate::Status::kOutOfView:
      return GuardReason::kLost;
    case Certificate::Status::kForbidden:
      return GuardReason::kForbidden;
    case Certificate::Status::kTooFast:
      return GuardReason::kSlowZone;
    case Certificate::Status::kOverBudget:
      return GuardReason::kOverBudget;
    default:
      return GuardReason::kMap;
  }
}

}  // namespace

bool follows_plan(GuardReason reason) {
  switch (reason) {
    case GuardReason::kStale:
    case GuardReason::kMap:
    case GuardReason::kLost:
    case GuardReason::kForbidden:
    case GuardReason::kSlowZone:
    case GuardReason::kOverBudget:
      return true;
    case GuardReason::kPassed:
    case GuardReason::kNonFinite:
    case GuardReason::kLimit:
    case GuardReason::kRate:
    case GuardReason::kVelocity:
    case GuardReason::kUncommitted:
      break;
  }
  return false;
}

std::string_view to_string(GuardReason reason) {
  switch (reason) {
    case GuardReason::kPassed:
      return "passed";
    case GuardReason::kNonFinite:
      return "non-finite";
    case GuardReason::kLimit:
      return "limit";
    case GuardReason::kRate:
      return "rate";
    case GuardReason::kVelocity:
      return "velocity";
    case GuardReason::kStale:
      return "stale";
    case GuardReason::kUncommitted:
      return "uncommitted";
    case GuardReason::kMap:
      return "map";
    case GuardReason::kLost:
      return "lost";
    case GuardReason::kForbidden:
      return "forbidden";
    case GuardReason::kSlowZone:
      return "slow zone";
    case GuardReason::kOverBudget:
      return "over budget";
  }
  return "?";
}

Guard::Guard(std::shared_ptr<const MotionModel> model, const RobotShape& shape,
             const Certifier::Options& certificate, Options options)
    : model_(std::move(model)), certifier_(shape, certificate), options_(options) {
  if (!model_) throw std::invalid_argument("guard: no motion model; expected one");
  check_knobs("guard", options_);
  const int yaw = model_->nu() - 1;
  for (int j = 0; j < yaw; ++j) {
    linear_acceleration_ = std::hypot(linear_acceleration_, largest_acceleration(*model_, j));
  }
  angular_acceleration_ = largest_acceleration(*model_, yaw);
}

Twist Guard::hardest_braking(const Twist& previous, const Belief& newest, double dt) const {
  // Braking does not depend on where the robot is: a lost pose does not stop it from braking.
  const Pose pose = is_finite(newest.pose) ? newest.pose : Pose();
  const Eigen::VectorXd x = model_->state(pose, previous);
  const Eigen::VectorXd u = model_->braking_input(x, model_->input(previous), dt);
  Eigen::VectorXd next(model_->nx());
  model_->step(x, u, dt, next);
  return limited_twist(*model_, model_->twist(next, u));
}

std::vector<Twist> Guard::stop_commands(const Plan* along, const Pose& pose, const Twist& previous,
                                        const Belief& newest, double step) const {
  std::vector<Twist> commands;
  if (is_finite(previous) && step >= Options::kMinStep && step <= options_.max_step) {
    // Braking does not depend on where the robot is: a lost pose does not stop it from braking.
    const bool located = is_finite(pose);
    const Twist from = limited_twist(*model_, previous);
    Eigen::VectorXd x = model_->state(located ? pose : Pose(), from), next(model_->nx());
    const Stop stop = choose_stop(certifier_, newest, *model_, located ? along : nullptr, x,
                                  model_->input(from), step);
    for (Eigen::Index k = 0; k < stop.inputs.cols(); ++k) {
      model_->step(x, stop.inputs.col(k), step, next);
      commands.push_back(limited_twist(*model_, model_->twist(next, stop.inputs.col(k))));
      x.swap(next);
    }
  }
  if (commands.empty()) commands.emplace_back();
  return commands;
}

GuardVerdict Guard::stop(GuardReason reason, const std::string& detail, const Twist& previous,
                         const Belief& newest, double dt, const Plan* along,
                         const Pose& pose) const {
  GuardVerdict verdict;
  verdict.reason = reason;
  verdict.detail = detail;
  if (dt >= Options::kMinStep && dt <= options_.max_step) verdict.duration = dt;
  if (!is_finite(previous)) return verdict;
  verdict.command = along != nullptr && follows_plan(reason)
                        ? stop_commands(along, pose, previous, newest, verdict.duration).front()
                        : hardest_braking(previous, newest, verdict.duration);
  return verdict;
}

bool Guard::brakes(const Twist& command, const Twist& previous, const Belief& newest,
                   double dt) const {
  const Twist from = limited_twist(*model_, previous);
  const Twist hardest = hardest_braking(from, newest, dt);
  const double m = model_->num_state_constraints() > 0 ? options_.mismatch : 0.0;
  const double slack = options_.tolerance * model_->max_speed();
  const double speed = from.linear.norm(), least = hardest.linear.norm();
  return command.linear.norm() <= least + m * std::max(0.0, speed - least) + slack &&
         (command.linear - hardest.linear).norm() <= m * speed + slack &&
         std::abs(command.yaw_rate - hardest.yaw_rate) <=
             options_.tolerance * model_->max_yaw_rate();
}

std::string Guard::stale_source(const Belief& newest, double now) const {
  const SourceStamps& stamps = newest.stamps;
  struct Source {
    const char* name;
    double stamp, limit;
  };
  for (const Source& source :
       {Source{"the newest belief is", newest.stamp, options_.max_belief_age},
        {"the pose is", stamps.pose, options_.max_pose_age},
        {"the map is", stamps.map, options_.max_map_age},
        {"the landmarks are", stamps.landmarks, options_.max_landmarks_age},
        {"the ranges are", stamps.ranges, options_.max_ranges_age}}) {
    const double age = now - source.stamp;
    if (age <= source.limit && age >= -kFuture && std::isfinite(age)) continue;
    char text[120];
    if (age < -kFuture) {
      std::snprintf(text, sizeof text, "%s from the future, by %.3g s", source.name, -age);
    } else {
      std::snprintf(text, sizeof text, "%s %.1f s old; expected at most %.3g s", source.name, age,
                    source.limit);
    }
    return text;
  }
  return "";
}

bool Guard::within_rates(const Twist& command, const Twist& previous, double dt) const {
  const double slack = 1.0 + options_.tolerance;
  const double allowed = slack * linear_acceleration_ * dt + options_.tolerance;
  double change = (command.linear - previous.linear).norm();
  if (model_->num_state_constraints() > 0) {
    // A velocity that is held in W turns in B as the body turns beneath it.
    const Eigen::AngleAxisd turned(command.yaw_rate * dt, Eigen::Vector3d::UnitZ());
    change = std::min(change, (turned * command.linear - previous.linear).norm());
  }
  return change <= allowed && std::abs(command.yaw_rate - previous.yaw_rate) <=
                                  slack * angular_acceleration_ * dt + options_.tolerance;
}

bool Guard::follows(const Twist& measured, const Twist& previous) const {
  const auto allowed = [this](double acceleration, double most) {
    return std::min(acceleration * Options::kLag, most) + options_.mismatch * most;
  };
  // To the nearest share of what was told.
  const Eigen::Vector3d& told = previous.linear;
  const double squared = told.squaredNorm();
  const double share =
      squared > 0.0 ? std::clamp(measured.linear.dot(told) / squared, 0.0, 1.0) : 0.0;
  const double turn = std::clamp(measured.yaw_rate, std::min(0.0, previous.yaw_rate),
                                 std::max(0.0, previous.yaw_rate));
  return (measured.linear - share * told).norm() <=
             allowed(linear_acceleration_, model_->max_speed()) &&
         std::abs(measured.yaw_rate - turn) <=
             allowed(angular_acceleration_, model_->max_yaw_rate());
}

bool Guard::can_be_at(const Pose& pose, const Belief& newest, double now, double hold) const {
  const double time = std::max(0.0, now - newest.stamp) + hold + Options::kLag;
  return (pose.position - newest.pose.position).norm() <=
             model_->max_speed() * time + Options::kPoseSlack &&
         std::abs(std::remainder(pose.yaw - newest.pose.yaw, 2.0 * M_PI)) <=
             model_->max_yaw_rate() * time + Options::kPoseSlack;
}

std::optional<Guard::Objection> Guard::objection(const Twist& command, const Twist& previous,
                                                 const Belief& newest, double dt,
                                                 double now) const {
  if (!is_finite(command) || !is_finite(previous) || !is_finite(newest.twist) ||
      !is_finite(newest.pose) || !std::isfinite(dt)) {
    return Objection{GuardReason::kNonFinite,
                     "the command, the pose, a velocity or the time step is not finite"};
  }
  if (!(dt >= Options::kMinStep && dt <= options_.max_step)) {
    return Objection{GuardReason::kLimit, "the plan's time step is " + std::to_string(dt) +
                                              " s; expected 0.001 to " +
                                              std::to_string(options_.max_step) + " s"};
  }
  const double slack = 1.0 + options_.tolerance;
  if (command.linear.norm() > slack * model_->max_speed() ||
      std::abs(command.yaw_rate) > slack * model_->max_yaw_rate()) {
    return Objection{GuardReason::kLimit, "the command is faster than the model allows"};
  }
  if (!within_rates(command, previous, dt)) {
    return Objection{GuardReason::kRate, "the command changes faster than the model allows"};
  }
  if (std::string stale = stale_source(newest, now); !stale.empty()) {
    return Objection{GuardReason::kStale, std::move(stale)};
  }
  if (!follows(newest.twist, previous)) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the measured velocity, %.2f m/s and %.2f rad/s, is none that the command in "
                  "force, %.2f m/s and %.2f rad/s, leads to",
                  newest.twist.linear.norm(), newest.twist.yaw_rate, previous.linear.norm(),
                  previous.yaw_rate);
    return Objection{GuardReason::kVelocity, text};
  }
  return std::nullopt;
}

std::optional<Guard::Objection> Guard::objection_to_stop(const Plan& plan, int stage,
                                                         const Twist& previous,
                                                         const Belief& newest) const {
  const Objection soft{GuardReason::kUncommitted,
                       "the stopping tail does not brake as hard as the model can"};
  const int stages = plan.committed - stage;
  if (stages < 1 || plan.committed > static_cast<int>(plan.inputs.size()) ||
      stages > certifier_.max_stages()) {
    return soft;
  }
  const Twist& command = plan.commands[static_cast<std::size_t>(stage)];
  const Twist from = limited_twist(*model_, previous);
  const double speed = from.linear.norm();
  const double least = hardest_braking(from, newest, plan.dt).linear.norm();
  const double m = model_->num_state_constraints() > 0 ? options_.mismatch : 0.0;
  const double slack = options_.tolerance * model_->max_speed();
  if (!(command.linear.norm() <= least + m * std::max(0.0, speed - least) + slack)) {
    return soft;
  }
  Eigen::MatrixXd inputs(model_->nu(), stages);
  const Eigen::VectorXd start = model_->state(newest.pose, from);
  Eigen::VectorXd x = start, next(model_->nx());
  for (int k = 0; k < stages; ++k) {
    const Eigen::VectorXd& u = plan.inputs[static_cast<std::size_t>(stage + k)];
    if (u.size() != model_->nu() || !u.allFinite()) return soft;
    inputs.col(k) = u;
    model_->step(x, u, plan.dt, next);
    x.swap(next);
    if (k > 0) continue;
    const Twist certified = model_->twist(x, u);
    if ((command.linear - certified.linear).norm() > m * speed + slack ||
        std::abs(command.yaw_rate - certified.yaw_rate) >
            options_.tolerance * model_->max_yaw_rate()) {
      return Objection{GuardReason::kUncommitted, "the command is not that of the stop's input"};
    }
  }
  if (!is_at_rest(model_->twist(x, inputs.col(stages - 1)))) return soft;
  const Certificate asked = certifier_.certify_inputs(newest, *model_, start, inputs, plan.dt);
  if (asked.ok()) return std::nullopt;
  const Certificate straight = certifier_.certify_inputs(
      newest, *model_, start, stopping_tail(*model_, start, model_->input(from), plan.dt), plan.dt);
  if (stops_no_worse(asked, straight)) return std::nullopt;
  return Objection{reason_of(asked.status), asked.detail};
}

GuardVerdict Guard::check(const Plan& plan, int stage, const Twist& previous, const Belief& newest,
                          double now) const {
  const Plan* path = plan.certified || plan.kind == PlanKind::kStoppingTail ? &plan : nullptr;
  const auto refuse = [&](GuardReason reason, const std::string& detail) {
    return stop(reason, detail, previous, newest, plan.dt, path, newest.pose);
  };
  try {
    if (stage < 0 || stage >= static_cast<int>(plan.commands.size())) {
      return refuse(GuardReason::kUncommitted, "the plan has no such stage");
    }
    const Twist& command = plan.commands[static_cast<std::size_t>(stage)];
    if (const auto wrong = objection(command, previous, newest, plan.dt, now)) {
      return refuse(wrong->reason, wrong->detail);
    }
    const double plan_age = now - plan.stamp;
    if (!(plan_age <= plan.committed * plan.dt + options_.plan_slack) || !(plan_age >= -kFuture)) {
      return refuse(GuardReason::kStale, "the plan is " + std::to_string(plan_age) + " s old");
    }
    if (plan.kind == PlanKind::kStoppingTail) {
      if (!brakes(command, previous, newest, plan.dt)) {
        if (const auto wrong = objection_to_stop(plan, stage, previous, newest)) {
          return refuse(wrong->reason, wrong->detail);
        }
      }
      return {command, plan.dt, GuardReason::kPassed, ""};
    }
    if (!plan.certified || stage >= plan.committed ||
        plan.committed > static_cast<int>(plan.inputs.size())) {
      return refuse(GuardReason::kUncommitted, "the plan is not certified up to this stage");
    }
    if (plan.committed > certifier_.max_stages()) {
      return refuse(GuardReason::kOverBudget, "the committed part has too many stages");
    }
    Eigen::MatrixXd remaining(model_->nu(), plan.committed - stage);
    for (int k = stage; k < plan.committed; ++k) {
      const Eigen::VectorXd& u = plan.inputs[static_cast<std::size_t>(k)];
      if (u.size() != model_->nu() || !u.allFinite()) {
        return refuse(GuardReason::kNonFinite, "an input of the plan is not finite");
      }
      remaining.col(k - stage) = u;
    }
    // What is certified is the motion under the inputs; what is sent is the command.
    const Eigen::VectorXd x = model_->state(newest.pose, previous);
    Eigen::VectorXd next(model_->nx());
    model_->step(x, remaining.col(0), plan.dt, next);
    const Twist certified = model_->twist(next, remaining.col(0));
    const double mismatch = model_->num_state_constraints() > 0 ? options_.mismatch : 1e-6;
    if ((certified.linear - command.linear).norm() > mismatch * model_->max_speed() ||
        std::abs(certified.yaw_rate - command.yaw_rate) > mismatch * model_->max_yaw_rate()) {
      return refuse(GuardReason::kUncommitted, "the command is not that of the certified input");
    }
    const Certificate certificate =
        certifier_.certify(newest, *model_, x, model_->input(previous), remaining, plan.dt);
    if (!certificate.ok()) return refuse(reason_of(certificate.status), certificate.detail);
    return {command, plan.dt, GuardReason::kPassed, ""};
  } catch (const std::exception& e) {
    return refuse(GuardReason::kMap, std::string("checking failed: ") + e.what());
  }
}

GuardVerdict Guard::check(const Plan& plan, const TimedCommand& asked, const Twist& previous,
                          const Belief& newest, double now) const {
  const Plan* path = plan.certified || plan.kind == PlanKind::kStoppingTail ? &plan : nullptr;
  const auto refuse = [&](GuardReason reason, const std::string& detail) {
    return stop(reason, detail, previous, newest, asked.step, path,
                asked.pose.value_or(newest.pose));
  };
  try {
    if (!asked.pose) {
      return refuse(GuardReason::kNonFinite, "the command has no pose; expected where it acts");
    }
    if (asked.input.size() != model_->nu() || !asked.input.allFinite() || !is_finite(previous) ||
        !is_finite(*asked.pose) || !std::isfinite(asked.step) || !std::isfinite(asked.hold)) {
      return refuse(GuardReason::kNonFinite,
                    "the input, the pose, the command in force or a time is not finite");
    }
    if (!(asked.step >= Options::kMinStep && asked.step <= options_.max_step &&
          asked.hold >= asked.step && asked.hold <= options_.max_step && asked.share >= 0.0 &&
          asked.share <= 1.0)) {
      return refuse(GuardReason::kLimit, "the command is held for " + std::to_string(asked.hold) +
                                             " s, in steps of " + std::to_string(asked.step) +
                                             " s; expected 0.001 to " +
                                             std::to_string(options_.max_step) +
                                             " s, no shorter than a step, and a share from 0 to 1");
    }
    const Eigen::VectorXd x = model_->state(*asked.pose, previous);
    Eigen::VectorXd next(model_->nx());
    model_->step(x, asked.input, asked.step, next);
    const Twist command = model_->twist(next, asked.input);
    if (const auto wrong = objection(command, previous, newest, asked.step, now);
        wrong && !(asked.following_watched && wrong->reason == GuardReason::kVelocity)) {
      return refuse(wrong->reason, wrong->detail);
    }
    if (!can_be_at(*asked.pose, newest, now, asked.hold)) {
      return refuse(
          GuardReason::kMap,
          "the pose of the command is none that the robot gets to from the newest belief");
    }
    const PlanPhase phase = plan.phase_at(now);
    if (phase != PlanPhase::kCommitted || plan.kind == PlanKind::kStoppingTail) {
      if (!brakes(command, previous, newest, asked.step)) {
        return refuse(GuardReason::kUncommitted,
                      "past the committed part the command does not brake as hard as it can");
      }
      return {command, asked.step, GuardReason::kPassed, ""};
    }
    if (!plan.certified) return refuse(GuardReason::kUncommitted, "the plan is not certified");
    Twist wanted = plan.command_at(plan.ramp_from ? now + asked.step : now);
    wanted.linear *= asked.share;
    wanted.yaw_rate *= asked.share;
    if ((command.linear - wanted.linear).norm() >
            (previous.linear - wanted.linear).norm() + options_.tolerance * model_->max_speed() ||
        std::abs(command.yaw_rate - wanted.yaw_rate) >
            std::abs(previous.yaw_rate - wanted.yaw_rate) +
                options_.tolerance * model_->max_yaw_rate()) {
      return refuse(GuardReason::kUncommitted, "the command does not lead to that of the plan");
    }
    const double steps = std::ceil(asked.hold / asked.step - kStepRounding);
    if (!(steps <= certifier_.max_stages())) {
      return refuse(GuardReason::kOverBudget, "the command is held for too many steps");
    }
    // What is held after the first step is the velocity.
    Eigen::MatrixXd inputs = model_->input(command).replicate(1, static_cast<Eigen::Index>(steps));
    inputs.col(0) = asked.input;
    const Certificate certificate =
        certifier_.certify(newest, *model_, x, model_->input(previous), inputs, asked.step);
    if (!certificate.ok()) return refuse(reason_of(certificate.status), certificate.detail);
    return {command, asked.step, GuardReason::kPassed, ""};
  } catch (const std::exception& e) {
    return refuse(GuardReason::kMap, std::string("checking failed: ") + e.what());
  }
}

void describe(Knobs& knobs, Guard::Options& o) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  knobs.number("max_belief_age", o.max_belief_age, {0.0, kAny}, "s", "oldest belief acted on");
  knobs.number("max_pose_age", o.max_pose_age, {0.0, kAny}, "s",
               "oldest pose acted on; twice the period of the images, if that is more");
  knobs.number("max_map_age", o.max_map_age, {0.0, kAny}, "s",
               "oldest map acted on; twice the period of the depth images, if that is more");
  knobs.number("max_landmarks_age", o.max_landmarks_age, {0.0, kAny}, "s",
               "oldest landmarks acted on; twice the period of the images, if that is more");
  knobs.number("max_ranges_age", o.max_ranges_age, {0.0, kAny}, "s",
               "oldest depth image acted on; twice their period, if that is more");
  knobs.number("plan_slack", o.plan_slack, {0.0, 3600.0}, "s",
               "that a plan may outlive its committed part");
  knobs.number("max_step", o.max_step, {Guard::Options::kMinStep, 3600.0}, "s",
               "longest time that a command is held; a stage of the plan, if that is longer");
  knobs.number("tolerance", o.tolerance, {0.0, 0.1}, "1", "relative, on limits and rates");
  knobs.number("mismatch", o.mismatch, {0.0, 0.99}, "1",
               "share of the largest speeds by which a command may differ from its input's");
}

}  // namespace prospect
