// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/frontiers/frontier_planner.h"
#include "models/types.h"

namespace prospect::test {

/// A step of the simplest driver: up to `turned` [rad] towards the way down V, at its end towards
/// what the target looks at, and `driven` [m] down V once it faces about that way. Requires a
/// target. Returns the metres driven.
inline double follow(const GlobalPlan& global_plan, Pose& pose, double driven = 0.3,
                     double turned = 0.5) {
  const auto path = global_plan.cost_to_go->descend(pose.position.head<2>(), driven);
  double aim = global_plan.target->yaw;
  if (path.size() > 4) {
    const Eigen::Vector2d d = path.back() - path.front();
    aim = std::atan2(d.y(), d.x());
  }
  const double turn = std::remainder(aim - pose.yaw, 2.0 * M_PI);
  pose.yaw += std::clamp(turn, -turned, turned);
  if (std::abs(turn) >= 0.8 || path.empty()) return 0.0;
  const double moved = (path.back() - pose.position.head<2>()).norm();
  pose.position.head<2>() = path.back();
  return moved;
}

}  // namespace prospect::test
