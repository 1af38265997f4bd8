// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/stopping_plan.h"

#include <cmath>

#include "engine/safety/certificate.h"
#include "engine/safety/stop.h"
#include "models/limited_twist.h"

namespace prospect {

Plan stopping_plan(const Belief& belief, const MotionModel& model, double dt,
                   const StoppedStep& step, const std::string& why) {
  Plan plan;
  plan.kind = PlanKind::kStoppingTail;
  plan.stamp = belief.stamp;
  plan.dt = dt;
  plan.detail = why;
  plan.task = step.task;
  plan.mode = step.mode;
  plan.safety_level = step.safety_level;
  plan.why = "Brakes: " + why + '.';
  // A lost pose does not keep the robot from braking.
  const bool located = belief.pose.position.allFinite() && std::isfinite(belief.pose.yaw);
  const Twist twist = limited_twist(model, belief.command.value_or(belief.twist));
  Eigen::VectorXd x = model.state(located ? belief.pose : Pose(), twist);
  const bool chooses = located && step.along != nullptr && step.certifier != nullptr;
  const Eigen::MatrixXd tail =
      chooses ? choose_stop(*step.certifier, belief, model, step.along, x, model.input(twist), dt)
                    .inputs
              : stopping_tail(model, x, model.input(twist), dt);
  plan.states.push_back(x);
  Eigen::VectorXd next(model.nx());
  for (Eigen::Index k = 0; k < tail.cols(); ++k) {
    model.step(x, tail.col(k), dt, next);
    plan.commands.push_back(limited_twist(model, model.twist(next, tail.col(k))));
    plan.inputs.emplace_back(tail.col(k));
    x.swap(next);
    plan.states.push_back(x);
  }
  plan.committed = static_cast<int>(tail.cols());
  if (model.num_state_constraints() > 0) plan.ramp_from = twist;
  plan.certified = false;
  return plan;
}

}  // namespace prospect
