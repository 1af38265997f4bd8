#include "engine/guard.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

namespace prospect {
namespace {

bool finite(const Twist& t) { return t.linear.allFinite() && std::isfinite(t.yaw_rate); }

double limit(const InputLimits& limits, bool velocity_controlled, int j) {
  if (velocity_controlled) return limits.rate[j];
  return std::max(std::abs(limits.lower[j]), std::abs(limits.upper[j]));
}

}  // namespace

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
    case GuardReason::kStale:
      return "stale";
    case GuardReason::kUncommitted:
      return "uncommitted";
    case GuardReason::kMap:
      return "map";
  }
  return "?";
}

Guard::Guard(std::shared_ptr<const MotionModel> model, const RobotShape& shape,
             const Certifier::Options& certificate, Options options)
    : model_(std::move(model)), certifier_(shape, certificate), options_(options) {
  const bool velocity_controlled = model_->num_state_constraints() == 0;
  const InputLimits& limits = model_->limits();
  const int yaw = model_->nu() - 1;
  for (int j = 0; j < yaw; ++j) {
    const double a = limit(limits, velocity_controlled, j);
    linear_acceleration_ = std::hypot(linear_acceleration_, a);
  }
  // A yaw rate that is an input of an acceleration-controlled base may jump within its bounds.
  const bool yaw_rate_input = velocity_controlled || model_->name() != "multirotor";
  angular_acceleration_ = yaw_rate_input ? limit(limits, velocity_controlled, yaw)
                                         : std::numeric_limits<double>::infinity();
}

GuardVerdict Guard::stop(GuardReason reason, const std::string& detail, const Twist& previous,
                         const Belief& newest, double dt) const {
  GuardVerdict verdict;
  verdict.reason = reason;
  verdict.detail = detail;
  if (!finite(previous) || !newest.pose.position.allFinite() || !std::isfinite(newest.pose.yaw) ||
      !(dt > 0.0) || !std::isfinite(dt)) {
    return verdict;  // zero
  }
  const Eigen::VectorXd x = model_->state(newest.pose, previous);
  const Eigen::VectorXd u = model_->braking_input(x, model_->input(previous), dt);
  Eigen::VectorXd next(model_->nx());
  model_->step(x, u, dt, next);
  const Twist braking = model_->twist(next, u);
  if (finite(braking)) verdict.command = braking;
  return verdict;
}

GuardVerdict Guard::check(const Plan& plan, int stage, const Twist& previous, const Belief& newest,
                          double now) const {
  const auto refuse = [&](GuardReason reason, const std::string& detail) {
    return stop(reason, detail, previous, newest, plan.dt);
  };
  try {
    if (stage < 0 || stage >= static_cast<int>(plan.commands.size())) {
      return refuse(GuardReason::kUncommitted, "the plan has no such stage");
    }
    const Twist& command = plan.commands[static_cast<std::size_t>(stage)];
    if (!finite(command) || !finite(newest.twist) || !newest.pose.position.allFinite() ||
        !std::isfinite(newest.pose.yaw)) {
      return refuse(GuardReason::kNonFinite, "the command, the pose or the velocity is not finite");
    }
    const double slack = 1.0 + options_.tolerance;
    if (command.linear.norm() > slack * model_->max_speed() ||
        std::abs(command.yaw_rate) > slack * model_->max_yaw_rate()) {
      return refuse(GuardReason::kLimit, "the command is faster than the model allows");
    }
    if ((command.linear - previous.linear).norm() >
            slack * linear_acceleration_ * plan.dt + options_.tolerance ||
        std::abs(command.yaw_rate - previous.yaw_rate) >
            slack * angular_acceleration_ * plan.dt + options_.tolerance) {
      return refuse(GuardReason::kRate, "the command changes faster than the model allows");
    }
    const double age = now - newest.stamp;
    if (!(age <= options_.max_belief_age) || !(age >= -1e-6)) {
      return refuse(GuardReason::kStale, "the newest belief is " + std::to_string(age) + " s old");
    }
    const double plan_age = now - plan.stamp;
    if (!(plan_age <= plan.committed * plan.dt + options_.plan_slack) || !(plan_age >= -1e-6)) {
      return refuse(GuardReason::kStale, "the plan is " + std::to_string(plan_age) + " s old");
    }
    // A stopping tail is what would be done instead: it needs no certificate to pass.
    if (plan.kind == PlanKind::kStoppingTail) return {command, GuardReason::kPassed, ""};
    if (!plan.certified || stage >= plan.committed) {
      return refuse(GuardReason::kUncommitted, "the plan is not certified up to this stage");
    }
    Eigen::MatrixXd remaining(model_->nu(), plan.committed - stage);
    for (int k = stage; k < plan.committed; ++k) {
      remaining.col(k - stage) = plan.inputs[static_cast<std::size_t>(k)];
    }
    const Certificate certificate =
        certifier_.certify(newest, *model_, model_->state(newest.pose, previous),
                           model_->input(previous), remaining, plan.dt);
    if (!certificate.ok()) return refuse(GuardReason::kMap, certificate.detail);
    return {command, GuardReason::kPassed, ""};
  } catch (const std::exception& e) {
    return refuse(GuardReason::kMap, std::string("checking failed: ") + e.what());
  }
}

}  // namespace prospect
