// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/planner/planner.h"
#include "engine/safety/guard.h"

namespace prospect {

/// The guard that belongs to plans made with these parameters: robot.slice() and depth sensor,
/// guard_margin(), zones, and unknown space as free, for entering it was ruled out by the
/// certificate of the plan; but the newest map must know the ground of the motion (known_ground.h),
/// unless the parameters take unknown space for free. A time step of the parameters that is
/// longer than options.max_step raises that. Throws as Guard does.
Guard guard_for(const RobotDescription& robot, const PlannerParameters& parameters,
                Guard::Options options = {});

}  // namespace prospect
