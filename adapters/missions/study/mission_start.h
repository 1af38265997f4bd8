// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "engine/maps/grid.h"
#include "models/types.h"

namespace prospect {

/// Where the mission of a seed starts: seed 1 at `own`, any other at the centre of a column drawn
/// from `places` (nonzero), with a heading drawn from all. A function of its arguments alone, so
/// that conditions are paired by their start. Throws std::invalid_argument without a place.
Pose mission_start(const Pose& own, const Grid<std::uint8_t>& places, std::uint64_t seed);

}  // namespace prospect
