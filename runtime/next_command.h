// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/safety/plan.h"
#include "models/motion_model.h"
#include "runtime/predicted_belief.h"

namespace prospect {

/// A command, and the model's input over one step that leads to it from the command before.
struct NextCommand {
  Eigen::VectorXd input;
  Twist command;
};

/// The hardest braking over `step` [s] > 0 that the model allows, from the command `previous` in
/// force. What is not finite becomes rest.
NextCommand braking_command(const MotionModel& model, const Pose& pose, const Twist& previous,
                            double step);

/// What a command thread sends at time `now` [s] from a plan, after `previous`: in the committed
/// part the nearest that bounds and rates of the model allow to `share` of the plan's velocity (of
/// now; where it changes linearly, of now + step), so that velocities ramp; past it
/// braking_command(), which is the certified stop, in finer steps; before the plan begins and in a
/// stopping tail braking, too.
NextCommand next_command(const MotionModel& model, const Plan& plan, double share, const Pose& pose,
                         const Twist& previous, double now, double step);

/// Those that follow each other at each `step` [s] from `from` up to before `until`, if nothing
/// comes between. plan: null: braking.
std::vector<SentCommand> commands_to_come(const MotionModel& model, const Plan* plan, double share,
                                          const Twist& previous, double from, double until,
                                          double step);

}  // namespace prospect
