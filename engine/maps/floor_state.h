// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/maps/grid.h"
#include "engine/maps/voxel_grid.h"

namespace prospect {

/// What is known of the floor in one column of the map.
enum class FloorState {
  kUnseen,  ///< nothing says whether there is floor
  kThere,   ///< a surface within the robot's step of z = 0 was met
  kMissing  ///< rays went on through the floor's plane, and met nothing within the step
};

/// Layers of voxels in which floor lies that the robot can stand on: k_floor <= k < k_body.
struct FloorLayers {
  int k_floor = -1;  ///< the lowest whose top a robot gets down to
  int k_body = 1;    ///< the lowest that its body sweeps, at least 0
};

/// k_floor of a robot that gets down a step of `step` [m]: the lowest layer whose top is at z =
/// -step or above. A step deeper than 1e6 voxels counts as that.
int floor_layer(double step, double resolution);

/// The rule, from counts of a column: over the floor's layers how many are occupied; of those below
/// z = 0 how many are free, of how many. A hole or a step down is where all of them are free and
/// nothing is met above them either.
constexpr FloorState floor_state(int occupied, int free_below, int layers_below) {
  if (occupied > 0) return FloorState::kThere;
  return free_below == layers_below ? FloorState::kMissing : FloorState::kUnseen;
}

/// The same of column c in `voxels`; what lies outside of the grid is unknown. Whoever needs to
/// know whether a robot can stand somewhere asks this: ground map, certificate, worlds.
FloorState floor_state(const VoxelGrid& voxels, Cell c, const FloorLayers& layers);

}  // namespace prospect
