// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/stop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "models/limited_twist.h"
#include "models/tracking_input.h"

namespace prospect {
namespace {

constexpr int kMostSteps = 100;
constexpr int kMostStages = 1000;  // of a plan whose path is looked at
constexpr int kPieces = 8;         // of a stage of the plan
constexpr double kNear = 0.25;     // [m]
constexpr double kNearYaw = 0.5;   // [rad]
constexpr double kLever = 0.5;     // [m]: a yaw that is off counts as so much for each radian
constexpr double kStill = 0.02;    // [m/s]: a slower plan has no direction

double length_of(const Plan& plan) {
  const int committed =
      std::min(std::max(plan.committed, 0), static_cast<int>(plan.commands.size()));
  return plan.dt * static_cast<double>(static_cast<std::size_t>(committed) + plan.tail.size());
}

Pose moved(const Pose& pose, const Twist& twist, double dt) {
  const Eigen::AngleAxisd middle(pose.yaw + 0.5 * twist.yaw_rate * dt, Eigen::Vector3d::UnitZ());
  return {pose.position + middle * (dt * twist.linear), pose.yaw + twist.yaw_rate * dt};
}

/// Time of the plan [s] at which it is nearest to a pose; negative if it never is near.
double nearest_time(const MotionModel& model, const Plan& plan, const Pose& pose) {
  const double length = length_of(plan);
  const bool has_path = !plan.states.empty() && plan.states.front().size() == model.nx() &&
                        plan.states.front().allFinite() && std::isfinite(length) && length > 0.0 &&
                        std::isfinite(plan.stamp) &&
                        plan.commands.size() + plan.tail.size() <= kMostStages;
  if (!has_path) return -1.0;
  Pose at = model.pose(plan.states.front());
  const double piece = plan.dt / kPieces;
  const int pieces = static_cast<int>(std::lround(length / piece));
  double nearest = -1.0, least = 0.0;
  for (int n = 0; n <= pieces; ++n) {
    const double away = (at.position - pose.position).norm();
    const double turned = std::abs(std::remainder(at.yaw - pose.yaw, 2.0 * M_PI));
    const double distance = std::hypot(away, kLever * turned);
    if (away <= kNear && turned <= kNearYaw && (nearest < 0.0 || distance < least)) {
      nearest = n * piece;
      least = distance;
    }
    at = moved(at, plan.command_at(plan.stamp + (n + 0.5) * piece), piece);
  }
  return nearest;
}

/// The mean body velocity of the plan over [from, from + duration].
Twist mean_twist(const Plan& plan, double from, double duration) {
  Twist mean;
  for (int n = 0; n < kPieces; ++n) {
    const Twist twist = plan.command_at(plan.stamp + from + duration * (n + 0.5) / kPieces);
    mean.linear += twist.linear / kPieces;
    mean.yaw_rate += twist.yaw_rate / kPieces;
  }
  return mean;
}

/// A path for a stop: with the velocity in force, turning.
Plan turning(const Eigen::VectorXd& x, Twist twist, double yaw_rate) {
  Plan plan;
  plan.dt = 100.0;  // longer than any stop
  plan.committed = 1;
  plan.states = {x};
  twist.yaw_rate = yaw_rate;
  plan.commands = {twist};
  return plan;
}

}  // namespace

Eigen::MatrixXd stop_along(const MotionModel& model, const Plan& plan,
                           const Eigen::Ref<const Eigen::VectorXd>& x,
                           const Eigen::Ref<const Eigen::VectorXd>& u_previous, double dt) {
  Eigen::MatrixXd inputs(model.nu(), 0);
  double along = nearest_time(model, plan, model.pose(x));
  if (along < 0.0) return inputs;
  inputs.resize(model.nu(), kMostSteps);
  Eigen::VectorXd state = x, next(model.nx()), previous = u_previous, u(model.nu());
  for (int n = 0; n < kMostSteps; ++n) {
    u = model.braking_input(state, previous, dt);
    model.step(state, u, dt, next);
    const double speed = model.twist(next, u).linear.norm();
    // The mean is over as long as the robot takes, which the mean decides: the speed where it is
    // now comes near enough.
    const double here = mean_twist(plan, along, 0.25 * dt).linear.norm();
    const Twist mean = mean_twist(plan, along, here > kStill ? dt * speed / here : 0.0);
    if (speed > kStill && mean.linear.norm() > kStill) {
      const double share = speed / mean.linear.norm();
      u = tracking_input(model, state, previous, {share * mean.linear, share * mean.yaw_rate}, dt);
      model.step(state, u, dt, next);
      along += share * dt;
    }
    previous = u;
    inputs.col(n) = u;
    state.swap(next);
    if (is_at_rest(model.twist(state, u)) || !state.allFinite()) {
      inputs.conservativeResize(Eigen::NoChange, n + 1);
      break;
    }
  }
  return inputs;
}

bool stops_no_worse(const Certificate& a, const Certificate& b) {
  return a.ok() || (!b.ok() && a.time >= b.time);
}

Stop choose_stop(const Certifier& certifier, const Belief& belief, const MotionModel& model,
                 const Plan* plan, const Eigen::Ref<const Eigen::VectorXd>& x,
                 const Eigen::Ref<const Eigen::VectorXd>& u_previous, double dt) {
  const auto along = [&](const Plan& path) { return stop_along(model, path, x, u_previous, dt); };
  const auto straight = [&] { return stopping_tail(model, x, u_previous, dt, kMostSteps); };
  if (plan == nullptr) return {straight(), {}};
  Stop best;
  const auto touches = [&](Eigen::MatrixXd inputs) {
    if (inputs.cols() == 0) return true;
    const Certificate found = certifier.certify_inputs(belief, model, x, inputs, dt);
    if (best.inputs.cols() == 0 || !stops_no_worse(best.certificate, found)) {
      best = {std::move(inputs), found};
    }
    return !found.ok();
  };
  const Twist twist = model.twist(x, u_previous);
  if (touches(along(*plan)) && touches(straight()) &&
      touches(along(turning(x, twist, model.max_yaw_rate())))) {
    touches(along(turning(x, twist, -model.max_yaw_rate())));
  }
  return best;
}

}  // namespace prospect
