// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/task/polygon.h"
#include "engine/task/task.h"
#include "engine/task/zones.h"
#include "models/types.h"

namespace prospect {

// What is told in one frame, in another: T_AB is the place of B in A, in the plane. Its z does not
// count.

/// Of B, in A.
Eigen::Vector2d moved(const Eigen::Vector2d& in_B, const Pose& T_AB);
Polygon moved(Polygon in_B, const Pose& T_AB);
Zones moved(Zones in_B, const Pose& T_AB);
/// Its area and its goal; the goal of kReturn is a place that was measured, and stays.
Task moved(Task in_B, const Pose& T_AB);

}  // namespace prospect
