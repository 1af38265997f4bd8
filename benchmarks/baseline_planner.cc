// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/baseline_planner.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/maps/body_clearance.h"
#include "engine/maps/clearance_field.h"
#include "engine/planner/frontier_planner_options.h"
#include "engine/safety/certificate.h"
#include "engine/support/stopwatch.h"
#include "models/limited_twist.h"

namespace prospect {

struct BaselinePlanner::Impl {
  RobotDescription robot;
  PlannerParameters parameters;
  FrontierPlanner frontier_planner;
  DynamicWindowOptions window;
  // As Planner has them: the second where the path ahead is narrow, the last as the guard will
  // ask.
  std::optional<Certifier> certifier, close_certifier, guard_certifier;
  Behaviour behaviour;
  VerticalExtent slice{0.0, 0.0};
  int committed = 1;

  std::shared_ptr<const GlobalPlan> global_plan;
  std::shared_ptr<const ClearanceField> occupied;
  std::optional<double> escape_since;    // [s]
  std::optional<FrontierTarget> facing;  // the robot has arrived, and looks
  double facing_within = 0.3;            // [m] from the viewpoint

  Impl(FrontierRule rule, RobotDescription r, PlannerParameters p)
      : robot(std::move(r)),
        parameters(std::move(p)),
        frontier_planner(guided_by(rule, frontier_planner_options_for(robot, parameters))) {
    const PlannerParameters& q = parameters;
    if (!(q.dt > 0.0) || !(q.committed >= q.dt) || !(q.committed < 60.0)) {
      throw std::invalid_argument("frontier planner: dt = " + std::to_string(q.dt) +
                                  ", committed = " + std::to_string(q.committed) +
                                  "; expected 0 < dt <= committed < 60 s");
    }
    if (!(q.d_safe >= 0.0) || !(q.d_des > q.d_safe)) {
      throw std::invalid_argument("frontier planner: d_safe = " + std::to_string(q.d_safe) +
                                  ", d_des = " + std::to_string(q.d_des) +
                                  "; expected 0 <= d_safe < d_des");
    }
    window.dt = q.dt;
    window.d_safe = q.d_safe;
    window.d_des = q.d_des;
    committed = std::max(1, static_cast<int>(std::lround(q.committed / q.dt)));
    window.stages = std::max(committed, static_cast<int>(std::lround(1.75 / q.dt)));
    slice = robot.slice();
    Certifier::Options options = Certifier::options_for(robot);
    options.margin = q.certificate_margin;
    options.unknown = q.unknown;
    certifier.emplace(robot.shape, options);
    options.margin = 0.5 * q.certificate_margin;
    close_certifier.emplace(robot.shape, options);
    options.margin = q.guard_margin();
    options.unknown = UnknownPolicy::kFree;
    guard_certifier.emplace(robot.shape, options);
  }

  // A robot that stands and would go on standing, although it has somewhere to go, looks from where
  // it is if that is near the viewpoint. Farther off it must be so close to a corner that every
  // motion along the path is refused (the base may be unable to reverse): it gets away first, until
  // it has room again or for 4 s.
  void note_stuck(const Belief& belief, const DriveTask& task, const Plan& plan) {
    if (!task.target || task.arrived || task.escape) return;
    if (belief.twist.linear.norm() > 0.02 || std::abs(belief.twist.yaw_rate) > 0.05) return;
    if (plan.certified) {
      const Pose from = robot.model->pose(plan.states.front());
      const Pose to = robot.model->pose(plan.states.back());
      if ((to.position - from.position).norm() > 0.02 || std::abs(to.yaw - from.yaw) > 0.05) return;
    }
    const double distance = (task.target->viewpoint - belief.pose.position.head<2>()).norm();
    if (distance < 0.6 && !approaches()) {
      facing = task.target;
      facing_within = distance + 0.1;
    } else {
      escape_since = belief.stamp;
    }
  }
  bool escaping(const Pose& pose, const BodyClearance& body, double stamp) {
    if (!escape_since) return false;
    const bool free = body.clearance(pose) > 0.7 * std::min(parameters.d_des, body.saturation());
    if (free || stamp - *escape_since > 4.0 || stamp < *escape_since) escape_since.reset();
    return escape_since.has_value();
  }

  bool approaches() const { return behaviour.mode.kind == ModeKind::kApproach; }
  bool narrow() const { return global_plan->facts.narrow; }

  // Latched, so that the robot does not set off again for a viewpoint beside the one it stands at.
  bool arrived(const Pose& pose) {
    const std::optional<FrontierTarget>& target = global_plan->target;
    if (!target) {
      facing.reset();
      return false;
    }
    const double distance = (target->viewpoint - pose.position.head<2>()).norm();
    const bool same = facing && (facing->looks_at - target->looks_at).norm() < 1.0;
    // A robot that looks from beside the viewpoint without success must go right there.
    const double near = approaches() ? 0.08 : same ? facing_within : 0.15;
    if (distance < near) {
      if (!same) {
        facing = target;
        facing_within = 0.3;
      }
      return true;
    }
    facing.reset();
    return false;
  }

  void fill(const Eigen::VectorXd& x0, const Eigen::MatrixXd& inputs, Plan& plan) const {
    Eigen::VectorXd x = x0, next(robot.model->nx());
    plan.states.push_back(x);
    for (Eigen::Index k = 0; k < inputs.cols(); ++k) {
      robot.model->step(x, inputs.col(k), parameters.dt, next);
      plan.commands.push_back(limited_twist(*robot.model, robot.model->twist(next, inputs.col(k))));
      plan.inputs.emplace_back(inputs.col(k));
      x.swap(next);
      plan.states.push_back(x);
    }
  }

  Plan stopping_plan(const Belief& belief, const std::string& why) const {
    Plan plan;
    plan.kind = PlanKind::kStoppingTail;
    plan.stamp = belief.stamp;
    plan.dt = parameters.dt;
    plan.detail = why;
    // Braking does not depend on where the robot is, so a lost pose does not keep it from braking.
    const bool located = belief.pose.position.allFinite() && std::isfinite(belief.pose.yaw);
    const Twist twist = limited_twist(*robot.model, belief.command.value_or(belief.twist));
    const Eigen::VectorXd x = robot.model->state(located ? belief.pose : Pose(), twist);
    const Eigen::MatrixXd tail =
        stopping_tail(*robot.model, x, robot.model->input(twist), parameters.dt);
    fill(x, tail, plan);
    plan.committed = static_cast<int>(tail.cols());
    return plan;
  }

  Plan plan(const Belief& belief) {
    if (!belief.voxels || !belief.ground || !belief.pose.position.allFinite() ||
        !(belief.pose.position.cwiseAbs().maxCoeff() < 1e6) || !std::isfinite(belief.pose.yaw) ||
        !is_finite(belief.twist) || !std::isfinite(belief.stamp)) {
      return stopping_plan(belief, "a map is missing, or the belief is not finite");
    }
    Stopwatch total, watch;
    PlanTimes times;
    global_plan = frontier_planner.update(*belief.ground, belief.pose, belief.stamp,
                                          {.observed = belief.localization != Localization::kLost});
    // It does not look after its localization: to the table it is always localized.
    const Facts facts{.stamp = belief.stamp, .frontiers = global_plan->facts};
    behaviour = decide(behaviour, facts, parameters.behaviour);
    times.frontier_planner = watch.lap();

    ClearanceField::Options field;
    field.vertical = robot.model->pose_layout().pz >= 0;
    field.slice = slice;
    field.reach = robot.model->max_speed() * window.stages * window.dt + 1.0;
    field.cutoff = std::max(0.8, circumscribed_radius(robot.shape) + parameters.d_des + 0.2);
    occupied = std::make_shared<const ClearanceField>(belief.pose.position, *belief.voxels,
                                                      *belief.ground, field, occupied.get());
    const BodyClearance body(occupied, robot.shape);
    times.clearance = watch.lap();

    DriveTask task;
    task.x0 = robot.model->state(belief.pose, belief.twist);
    const InputLimits& limits = robot.model->limits();
    task.u_previous =
        robot.model->input(belief.twist).cwiseMax(limits.lower).cwiseMin(limits.upper);
    task.cost_to_go = global_plan->cost_to_go.get();
    task.target = global_plan->target;
    task.arrived = arrived(belief.pose);
    task.escape = !task.arrived && escaping(belief.pose, body, belief.stamp);
    window.d_safe = narrow() ? 0.0 : parameters.d_safe;
    const std::vector<DriveCandidate> candidates = dynamic_window(*robot.model, body, task, window);
    times.seeds = watch.lap();

    constexpr int kAttempts = 40;
    std::string refused;
    Plan plan;
    int attempts = 0;
    for (const DriveCandidate& c : candidates) {
      // To stop is worth a try whatever its rank.
      if (attempts >= kAttempts && !c.stops) continue;
      ++attempts;
      const Eigen::MatrixXd leading = c.inputs.leftCols(committed);
      Certificate certificate =
          (narrow() ? close_certifier : certifier)
              ->certify(belief, *robot.model, task.x0, task.u_previous, leading, parameters.dt);
      if (certificate.ok()) {
        certificate = guard_certifier->certify(belief, *robot.model, task.x0, task.u_previous,
                                               leading, parameters.dt);
      }
      if (!certificate.ok()) {
        if (refused.empty()) refused = certificate.detail;
        continue;
      }
      plan.kind = PlanKind::kSeed;
      plan.stamp = belief.stamp;
      plan.dt = parameters.dt;
      fill(task.x0, c.inputs, plan);
      plan.committed = committed;
      plan.certified = true;
      plan.certificate = certificate.detail;
      plan.seed = c.name;
      plan.quality = Quality::kFeasible;
      break;
    }
    note_stuck(belief, task, plan);
    if (!plan.certified) {
      plan = stopping_plan(belief, "no candidate could be certified: " + refused);
    }
    plan.mode = behaviour.mode;
    plan.why = describe(behaviour.mode, facts);
    plan.solver = "dynamic window";
    plan.has_active_frontier = global_plan->target.has_value();
    plan.seeds_scored = static_cast<int>(candidates.size());
    times.certify = watch.lap();
    times.total = total.lap();
    plan.times = times;
    return plan;
  }
};

BaselinePlanner::BaselinePlanner(FrontierRule rule, RobotDescription robot,
                                 PlannerParameters parameters)
    : impl_(std::make_unique<Impl>(rule, std::move(robot), std::move(parameters))) {}
BaselinePlanner::~BaselinePlanner() = default;

Plan BaselinePlanner::plan(const Belief& belief) {
  try {
    return impl_->plan(belief);
  } catch (const std::exception& e) {
    return impl_->stopping_plan(belief, std::string("planning failed: ") + e.what());
  } catch (...) {
    return impl_->stopping_plan(belief, "planning failed");
  }
}

std::shared_ptr<const GlobalPlan> BaselinePlanner::global_plan() const {
  return impl_->global_plan;
}

PlannerParameters nearest_frontier_parameters(PlannerParameters p) {
  p.frontier_planner = guided_by(FrontierRule::kNearest, p.frontier_planner);
  p.weights.visible_features = 0.0;
  p.w_c = 0.0;
  p.target_frontier_only = true;
  return p;
}

}  // namespace prospect
