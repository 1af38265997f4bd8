// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "models/motion_model.h"

namespace prospect {

/// Whether the base can move without turning towards `direction` (unit vector in B, x ahead, y
/// left): a twentieth of its largest speed that way is within its limits and its kinematics.
/// Thread-safety: none needed. Never throws.
inline bool can_move(const MotionModel& model, const Eigen::Vector2d& direction) {
  Twist wanted;
  wanted.linear.head<2>() = 0.05 * model.max_speed() * direction;
  const InputLimits& limits = model.limits();
  const Eigen::VectorXd u = model.input(wanted).cwiseMax(limits.lower).cwiseMin(limits.upper);
  const Eigen::VectorXd x = model.state(Pose(), wanted);
  if (model.num_state_constraints() > 0) {
    Eigen::VectorXd values(model.num_state_constraints());
    model.state_constraints(x, values, nullptr);
    if (values.minCoeff() < 0.0) return false;
  }
  return (model.twist(x, u).linear - wanted.linear).norm() < 1e-6 * model.max_speed();
}

}  // namespace prospect
