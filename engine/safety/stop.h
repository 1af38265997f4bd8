// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/maps/belief.h"
#include "engine/safety/certificate.h"
#include "engine/safety/plan.h"
#include "models/motion_model.h"

namespace prospect {

/// The stop along the path that a plan leads over: it brakes as hard as stopping_tail() does, and
/// steers as the plan does at the same place. With h the hardest braking over the next dt, p(s) the
/// plan's body velocity at the time s of the plan, and s the time at which the plan's pose is
/// nearest to the robot's, the velocity to be had is
///   (|h| / |p|) p,   p the mean of p(.) over [s, s + dt |h| / |p|],   then s += dt |h| / |p|;
/// so the curvature is the plan's, whatever the speed. Where the plan stands or turns on the spot
/// it is h. Bounds and rates of the model hold (tracking_input.h).
///
/// x, u_previous: as of stopping_tail(), finite; inputs: nu x n, each for dt [s], n <= 100. No
/// columns if the robot is not on the path (0.25 m, 0.5 rad), or the plan has none.
///
/// Pure. Cost: some hundred steps of the model. Source: our choice.
Eigen::MatrixXd stop_along(const MotionModel& model, const Plan& plan,
                           const Eigen::Ref<const Eigen::VectorXd>& x,
                           const Eigen::Ref<const Eigen::VectorXd>& u_previous, double dt);

/// A stop, and what the newest map says of it.
struct Stop {
  Eigen::MatrixXd inputs;  ///< nu x n, each for dt
  Certificate certificate;
};

/// The stop to drive: that along the plan's path if it touches nothing, because what the plan's
/// certificate covered was free, and what is beside it nobody has asked about; else the straight
/// one (stopping_tail()), else the hardest turn to either side. If all touch something, the one
/// that touches last, when the robot is slower. plan: null: the straight one, unchecked. Does not
/// throw but by lack of memory.
Stop choose_stop(const Certifier& certifier, const Belief& belief, const MotionModel& model,
                 const Plan* plan, const Eigen::Ref<const Eigen::VectorXd>& x,
                 const Eigen::Ref<const Eigen::VectorXd>& u_previous, double dt);

/// Whether a stop with the certificate `a` is to be driven rather than one with `b`: it is free, or
/// touches no earlier.
bool stops_no_worse(const Certificate& a, const Certificate& b);

}  // namespace prospect
