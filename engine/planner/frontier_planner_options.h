// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/frontiers/frontier_planner.h"
#include "engine/planner/planner.h"

namespace prospect {

/// parameters.frontier_planner, with what the frontier planner must know about the robot (size,
/// sensor, speed) filled in. Throws std::invalid_argument if the robot has no model or its shape or
/// depth sensor is unusable.
FrontierPlannerOptions frontier_planner_options_for(const RobotDescription& robot,
                                                    const PlannerParameters& parameters);

}  // namespace prospect
