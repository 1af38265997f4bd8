#include "engine/guard.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <stdexcept>

#include "engine/limited_twist.h"

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
  if (!model_) throw std::invalid_argument("guard: no motion model; expected one");
  const int yaw = model_->nu() - 1;
  for (int j = 0; j < yaw; ++j) {
    linear_acceleration_ = std::hypot(linear_acceleration_, largest_acceleration(*model_, j));
  }
  angular_acceleration_ = largest_acceleration(*model_, yaw);
}

GuardVerdict Guard::stop(GuardReason reason, const std::string& detail, const Twist& previous,
                         const Belief& newest, double dt) const {
  GuardVerdict verdict;
  verdict.reason = reason;
  verdict.detail = detail;
  if (!is_finite(previous) || !(dt > 0.0) || !std::isfinite(dt)) return verdict;  // zero
  // Braking does not depend on where the robot is: a lost pose does not stop it from braking.
  const Pose pose = is_finite(newest.pose) ? newest.pose : Pose();
  const Eigen::VectorXd x = model_->state(pose, previous);
  const Eigen::VectorXd u = model_->braking_input(x, model_->input(previous), dt);
  Eigen::VectorXd next(model_->nx());
  model_->step(x, u, dt, next);
  verdict.command = limited_twist(*model_, model_->twist(next, u));
  return verdict;
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

GuardVerdict Guard::check(const Plan& plan, int stage, const Twist& previous, const Belief& newest,
                          double now) const {
  const auto refuse = [&](GuardReason reason, const std::string& detail) {
    return stop(reason, detail, previous, newest, plan.dt);
  };
  try {
    if (stage < 0 || stage >= static_cast<int>(plan.commands.size())) {
      return refuse(GuardReason::kUncommitted, "the plan has no such stage");
    }
    const auto at = static_cast<std::size_t>(stage);
    const Twist& command = plan.commands[at];
    if (!is_finite(command) || !is_finite(previous) || !is_finite(newest.twist) ||
        !is_finite(newest.pose) || !std::isfinite(plan.dt)) {
      return refuse(GuardReason::kNonFinite,
                    "the command, the pose, a velocity or the time step is not finite");
    }
    const double slack = 1.0 + options_.tolerance;
    if (command.linear.norm() > slack * model_->max_speed() ||
        std::abs(command.yaw_rate) > slack * model_->max_yaw_rate()) {
      return refuse(GuardReason::kLimit, "the command is faster than the model allows");
    }
    if (!within_rates(command, previous, plan.dt)) {
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
    // A stopping tail is what would be done instead: it needs no certificate, but it has to slow
    // down.
    if (plan.kind == PlanKind::kStoppingTail) {
      if (command.linear.norm() > previous.linear.norm() + options_.tolerance ||
          std::abs(command.yaw_rate) > std::abs(previous.yaw_rate) + options_.tolerance) {
        return refuse(GuardReason::kUncommitted, "the stopping tail does not slow down");
      }
      return {command, GuardReason::kPassed, ""};
    }
    if (!plan.certified || stage >= plan.committed ||
        plan.committed > static_cast<int>(plan.inputs.size())) {
      return refuse(GuardReason::kUncommitted, "the plan is not certified up to this stage");
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
    if (!certificate.ok()) return refuse(GuardReason::kMap, certificate.detail);
    return {command, GuardReason::kPassed, ""};
  } catch (const std::exception& e) {
    return refuse(GuardReason::kMap, std::string("checking failed: ") + e.what());
  }
}

}  // namespace prospect
