// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "models/robot_description.h"

namespace prospect {

struct PlannerParameters;

/// Variables of a step's problem.
inline constexpr int kMostVariables = 200;
/// Landmarks that an evaluation of the problem looks at, at each stage.
inline constexpr double kMostViews = 2e6;
/// With a deadline, for each second of it: a step without time for more evaluates a few times.
inline constexpr double kMostViewsPerSecond = 1e7;
/// These, three times the default, whatever the deadline.
inline constexpr double kLeastViews = 2e4;
/// Voxels of half a side of the window of the cost-to-go.
inline constexpr int kMostWindow = 1000;

/// How far obstacles matter to a step [m]: the body's radius, d_des, drift_margin and 0.2 m, at
/// least 0.8 m and a voxel of the maps, whose side is `resolution` [m].
double clearance_cutoff(const RobotDescription& robot, const PlannerParameters& parameters,
                        double resolution);

/// What robot, parameters and the resolution of the maps [m] must agree in, by the arithmetic of
/// what a step needs:
///
///   distances   clearance_cutoff / resolution voxels: at most ClearanceField::kMostVoxels, of a
///               base that moves in 3-D kMostVoxelsInSpace
///   window      frontier_planner.cost_to_go.window_radius / resolution: at most kMostWindow voxels
///   motion      max_deceleration N dt, the speed that it can get to within the horizon: more than
///               1 mm/s, which counts as rest
///   variables   M nu: at most kMostVariables. The time of a back end that uses second derivatives
///               grows with their cube
///   looks       N max_landmarks: at most kMostViews, and with a deadline kMostViewsPerSecond times
///               that, but kLeastViews. The time of each evaluation grows with it
///
/// How far the robot can get within the horizon needs no limit: what a step keeps is bounded by
/// what is known of the world (clearance_field.h, occlusion_table.h).
/// "" or what does not fit, with the keys, the numbers and what would. The Planner's constructor
/// and each of its steps ask this, and so does whoever reads a configuration. Of sound values; 0:
/// of a resolution that is not known yet.
std::string planner_misfit(const RobotDescription& robot, const PlannerParameters& parameters,
                           double resolution);

}  // namespace prospect
