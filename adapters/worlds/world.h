#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/voxel_grid.h"
#include "models/types.h"

namespace prospect {

/// A true world for the simulator: what is where, and how much texture its surfaces carry.
///
/// Voxels: kOccupied, kFree, or kUnknown; unknown voxels of the source map are solid to the robot and
/// opaque to its sensors. The floor is z = 0 of W: readers shift a map by whole voxels so that the
/// floor's surface lies there, and make the layer just below z = 0 occupied under every free column.
struct World {
  std::string name;
  VoxelGrid voxels;
  Pose start;  ///< B's origin on the floor
  /// Texture density of a surface voxel [features/m^2], by class; texture_class holds one index per
  /// voxel (same indexing as voxels.data()). Empty texture_class: the source says nothing of texture
  /// and a seeded patchy field is used.
  std::vector<double> texture_density;
  std::vector<std::uint8_t> texture_class;

  bool solid(int i, int j, int k) const { return voxels.state(i, j, k) != CellState::kFree; }
};

}  // namespace prospect
