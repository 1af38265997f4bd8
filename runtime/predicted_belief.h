// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "engine/maps/belief.h"
#include "models/types.h"

namespace prospect {

class Knobs;

/// How long after it was sent a command begins to act [s], >= 0: transport, firmware and what the
/// motors take to follow, as a pure delay. Linear and angular motion often differ.
struct ActuationDelay {
  double linear = 0.0;
  double angular = 0.0;

  double longest() const { return linear > angular ? linear : angular; }
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, ActuationDelay& delay);

/// A body velocity that was sent at a time [s] and stays in force until the next one.
struct SentCommand {
  double time = 0.0;
  Twist command;
};

/// Where a robot is once all commands sent before time `until` [s] have acted, given that it was at
/// `pose` at time `from` [s]. The linear velocity at time t is that of the command in force at
/// t - delay.linear, the yaw rate that of the one in force at t - delay.angular; before the first
/// command they are zero. Both go on up to `until` plus the own delay. Over each piece of constant
/// velocity the pose moves along an arc, as the models do:
///   p' = p + R(yaw + w dt / 2) v dt sinc(w dt / 2),   yaw' = yaw + w dt.
/// commands: in order of time. Pure. With delays apart, the linear motion that lags behind the
/// angular one is rolled over yaws that later commands would have changed: off by no more than
/// |v| |w| (difference of the delays)^2.
Pose predicted_pose(const Pose& pose, double from, std::span<const SentCommand> commands,
                    double until, const ActuationDelay& delay);

/// What a planner is to plan from, whose plan takes effect at time `start` [s] in the clock of the
/// belief's stamp: the belief with
///   pose      where the commands sent before `start` lead (predicted_pose());
///   twist     the command in force at `start`, and so `command`;
///   stamp     `start`. The stamps of the sources stay: what is old does not become new.
/// Maps and covariance are those that are known. A `start` before the belief's stamp is taken as
/// that stamp.
Belief predicted_belief(const Belief& belief, std::span<const SentCommand> commands, double start,
                        const ActuationDelay& delay);

}  // namespace prospect
