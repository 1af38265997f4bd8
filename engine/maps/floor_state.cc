// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/floor_state.h"

#include <algorithm>
#include <cmath>

namespace prospect {

int floor_layer(double step, double resolution) {
  constexpr double kMostLayersDown = 1e6;
  const double down = std::floor(step / resolution + kFaceTolerance);
  return -1 - static_cast<int>(std::clamp(down, 0.0, kMostLayersDown));
}

FloorState floor_state(const VoxelGrid& voxels, Cell c, const FloorLayers& layers) {
  if (!voxels.frame().contains(c)) return FloorState::kUnseen;
  const int first = std::max(layers.k_floor, voxels.k0());
  const int end = std::min(layers.k_body, voxels.k0() + voxels.depth());
  int occupied = 0, free_below = 0;
  for (int k = first; k < end; ++k) {
    const CellState s = voxels.state(c.i, c.j, k);
    occupied += s == CellState::kOccupied;
    free_below += k < 0 && s == CellState::kFree;
  }
  return floor_state(occupied, free_below, -layers.k_floor);
}

}  // namespace prospect
