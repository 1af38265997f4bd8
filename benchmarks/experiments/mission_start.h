#pragma once

#include <cstdint>

#include "adapters/worlds/reachable_area.h"
#include "models/types.h"

namespace prospect {

/// Where the mission of a seed starts: seed 1 at `own`, any other at the centre of a column drawn
/// from those on which the robot can stand, with a heading drawn from all. A function of its
/// arguments alone, so that conditions are paired by their start. `area` holds at least one
/// standing column.
Pose mission_start(const Pose& own, const ReachableArea& area, std::uint64_t seed);

}  // namespace prospect
