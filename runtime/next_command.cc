// SPDX-License-Identifier: Apache-2.0
#include "runtime/next_command.h"

#include <cmath>

#include "models/limited_twist.h"
#include "models/tracking_input.h"

namespace prospect {
namespace {

NextCommand with_command(const MotionModel& model, const Eigen::VectorXd& x, Eigen::VectorXd input,
                         double step) {
  Eigen::VectorXd next(model.nx());
  model.step(x, input, step, next);
  const Twist command = model.twist(next, input);
  return {std::move(input), command};
}

}  // namespace

NextCommand braking_command(const MotionModel& model, const Pose& pose, const Twist& previous,
                            double step) {
  const Twist from = limited_twist(model, previous);
  // Braking does not depend on where the robot is.
  const bool located = pose.position.allFinite() && std::isfinite(pose.yaw);
  const Eigen::VectorXd x = model.state(located ? pose : Pose(), from);
  NextCommand braking =
      with_command(model, x, model.braking_input(x, model.input(from), step), step);
  braking.command = limited_twist(model, braking.command);
  return braking;
}

NextCommand next_command(const MotionModel& model, const Plan& plan, double share, const Pose& pose,
                         const Twist& previous, double now, double step) {
  if (plan.phase_at(now) != PlanPhase::kCommitted || plan.kind == PlanKind::kStoppingTail) {
    return braking_command(model, pose, previous, step);
  }
  // Velocities that change linearly are those of the step's end, others those of their stage.
  Twist wanted = plan.command_at(plan.ramp_from ? now + step : now);
  wanted.linear *= share;
  wanted.yaw_rate *= share;
  const Eigen::VectorXd x = model.state(pose, previous);
  return with_command(model, x, tracking_input(model, x, model.input(previous), wanted, step),
                      step);
}

std::vector<SentCommand> commands_to_come(const MotionModel& model, const Plan* plan, double share,
                                          const Twist& previous, double from, double until,
                                          double step) {
  std::vector<SentCommand> commands;
  Twist before = previous;
  // By count: sums of steps would not meet `until`.
  for (int k = 0; step > 0.0 && from + k * step < until; ++k) {
    const double t = from + k * step;
    before = (plan ? next_command(model, *plan, share, Pose(), before, t, step)
                   : braking_command(model, Pose(), before, step))
                 .command;
    commands.push_back({t, before});
  }
  return commands;
}

}  // namespace prospect
