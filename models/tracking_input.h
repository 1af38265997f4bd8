// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "models/motion_model.h"

namespace prospect {

/// The admissible input that brings the body velocity after one step nearest to `desired`:
///   u = clamp( argmin_u |twist(f(x, u, dt), u) - desired|^2 ),
/// solved by Gauss-Newton steps from the braking input with numeric derivatives (one is exact for
/// the models of planar bases, whose body velocity after a step is linear in u; a multirotor's
/// turns with its yaw), then clamped into the bounds and into previous +- rate dt. What a simple
/// steering law needs, whatever the model.
///
/// x: nx, previous: nu (the input in force), dt [s] > 0. Never non-finite for finite arguments.
/// Thread-safety: no state. Source: our choice.
Eigen::VectorXd tracking_input(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& x,
                               const Eigen::Ref<const Eigen::VectorXd>& previous,
                               const Twist& desired, double dt);

}  // namespace prospect
