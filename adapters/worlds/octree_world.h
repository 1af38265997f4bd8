#pragma once

#include <string>

#include "adapters/worlds/world.h"

namespace octomap {
class OcTree;
}

namespace prospect {

struct OctreeWorldOptions {
  double height = 2.5;  ///< [m] above the floor that is kept
  /// [m] Voxels are merged to the largest multiple of the tree's resolution up to this (0: not): a
  /// merged voxel is occupied if any fine one is, free if at least half of them are, else unknown.
  double resolution = 0.0;
  std::size_t max_voxels = 400'000'000;
  /// [m^3] Largest pocket that is filled with free space; 0 leaves every unknown voxel unknown.
  double max_pocket = 1.0;
};

/// The world of an octree: dense voxels at the tree's resolution from one voxel below the floor to
/// `height` above it; what the tree does not know stays kUnknown, but for pockets.
///
/// A pocket is a set of unknown voxels, connected through faces, of at most max_pocket, whose other
/// face neighbours are all free: the blind spot of the sensor that made the map, left wherever it
/// stood. It becomes free (our choice): geb079 has a row of them at z = 0.5 m, each a false
/// obstacle as wide as the passage.
///
/// The floor (our choice): a voxel is a surface if it is occupied and the one above it is free. The
/// layer with the most surface voxels is the floor if they cover at least a tenth of what the
/// fullest layer has free; its upper side becomes z = 0. A tree without such a layer (the floor was
/// never mapped) gets its floor just below the lowest layer with at least half the free voxels of
/// the fullest one. The map is moved by whole voxels only. start is left at the origin: see
/// place_start.
///
/// Throws InputError if the tree has no free space or is larger than max_voxels.
World world_from_octree(const octomap::OcTree& tree, const std::string& name,
                        const OctreeWorldOptions& options = {});

}  // namespace prospect
