// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "engine/maps/floor_state.h"
#include "engine/maps/grid.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/voxel_grid.h"
#include "models/robot_description.h"

namespace octomap {
class OcTree;
}

namespace prospect {

/// The range of heights that the robot's body sweeps, z_min <= z <= z_max [m, in W].
struct HeightSlice {
  double z_min = 0.1;
  double z_max = 0.5;
  /// Height of the depth sensor's line of sight [m, in W]; none: what is free is seen through.
  std::optional<double> sight = std::nullopt;
  /// Drop of the floor [m] that the robot drives down, >= 0; where it is deeper is no ground. A
  /// robot that does not stand on the floor takes any.
  double step = 0.05;
};

/// Of a robot: its body's slice, and the height of its depth sensor as the line of sight. Throws as
/// RobotDescription::slice().
HeightSlice height_slice(const RobotDescription& robot);

/// The layers of voxels k_low <= k <= k_high that a slice overlaps by more than a micrometre.
struct SliceLayers {
  int k_low = 0;
  int k_high = 0;
  std::optional<int> k_sight;  ///< the layer that holds the line of sight
  FloorLayers floor;           ///< those that the robot stands on
  int count() const { return k_high - k_low + 1; }
};

/// Layers of `slice` on a lattice of `resolution` [m]; always at least one.
/// Throws std::invalid_argument if the slice or its line of sight is not finite, empty, the step
/// negative, or the resolution not positive.
SliceLayers slice_layers(const HeightSlice& slice, double resolution);

/// State of a ground cell from the counts of its column (formulation, section 2: the exploration
/// map is the octree projected on the ground plane; the rule is our choice):
///   occupied if occupied > 0, or the floor is known to be missing: the body cannot be there;
///   free if not, and any is known free;  unknown if nothing is known.
/// One free layer is enough: what lies behind a low obstacle is seen at the sensor's height only,
/// and a stricter rule leaves frontiers there that no observation resolves. A low obstacle not seen
/// from afar makes its cell occupied when the sensor comes near.
inline CellState project_column(int occupied, int free, FloorState floor = FloorState::kUnseen) {
  if (occupied > 0 || floor == FloorState::kMissing) return CellState::kOccupied;
  return free > 0 ? CellState::kFree : CellState::kUnknown;
}

/// State of cell c from its column in `voxels`; layers outside the grid are unknown.
CellState project_column(const VoxelGrid& voxels, Cell c, const SliceLayers& layers);

/// Whether sight passes a ground cell of state `column` whose voxel at the line of sight is in
/// state `sight`: known free, or unknown above what is free. A depth camera that measures nothing
/// beyond its range (no depth is no evidence of free space) knows of a wide room the floor and what
/// is under its looks down at it, not the height of its own eye.
inline bool see_through(CellState column, CellState sight) {
  return sight == CellState::kFree || (sight == CellState::kUnknown && column == CellState::kFree);
}

/// The same of cell c in `voxels`; without a line of sight, whether the cell is free.
bool see_through(const VoxelGrid& voxels, Cell c, const SliceLayers& layers);

/// Projects every column: the ground map of a whole grid, and `rim` unknown cells more on every
/// side. O(cells x layers).
GroundMap project(const VoxelGrid& voxels, const HeightSlice& slice, int rim = 0);

/// The three maps of a Belief, of one octree.
struct BeliefMaps {
  std::shared_ptr<const octomap::OcTree> octree;
  std::shared_ptr<const VoxelGrid> voxels;
  std::shared_ptr<const GroundMap> ground;
};

/// Dense mirror of the octree's leaves between z_min and z_max [m]: pruned leaves are expanded to
/// the finest level; a leaf is occupied where the tree says so, else free; what has no leaf is
/// unknown. Covers the leaves' ground rectangle (at least one cell), without what lies so far apart
/// that it would be nearly empty (known_extent.h). O(volume of the leaves / voxel volume). Throws
/// std::invalid_argument if z_min < z_max does not hold, or the rectangle has more than `max_cells`
/// ground cells.
VoxelGrid voxels_from_octree(const octomap::OcTree& octree, double z_min, double z_max,
                             int max_cells = 40'000'000);

/// Belief maps from an existing octree, for robots that keep their own OctoMap. The ground map has
/// a rim of a tile: frontier cells just beyond what is known lie in it, as in a map that grows.
/// Throws std::invalid_argument as voxels_from_octree, or if `octree` is null.
BeliefMaps belief_maps(std::shared_ptr<const octomap::OcTree> octree, const HeightSlice& slice,
                       double z_min, double z_max);

}  // namespace prospect
