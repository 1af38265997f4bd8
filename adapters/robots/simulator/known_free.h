// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/formats/worlds/world.h"
#include "engine/maps/planar_move.h"
#include "models/robot_shape.h"
#include "models/types.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

/// Columns of the map (lattice of `resolution` [m]) that are known to be free when a robot is
/// switched on: those whose centre lies in one of these discs [m, in W].
///
/// Where the start has room, one disc of body_radius + 3/4 resolution about it: every column that
/// the body meets at any heading. Room is body_radius + resolution from the centre of the world's
/// column at the start to everything that is not free at the heights of `slice`. With less, a disc
/// for the centre of each of those columns that is free in the world all over and joined to the
/// start by such ones (4-connected): what is not known to be free must not be entered, and a wall
/// beside the robot that is nearer than its sensor sees would never be found.
/// body_radius: about the body's origin. Deterministic.
std::vector<Disc> known_free(const World& world, const Pose& start, double body_radius,
                             const VerticalExtent& slice, double resolution);

/// Enters them into a map, up to `height` above `z` [m]. to_W: from the discs' frame to the map's.
void clear_free(OccupancyMapper& map, const std::vector<Disc>& discs, double z, double height,
                const PlanarMove& to_W = {});

}  // namespace prospect
