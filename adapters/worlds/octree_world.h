#pragma once

#include <string>

#include "adapters/worlds/world.h"

namespace octomap {
class OcTree;
}

namespace prospect {

struct OctreeWorldOptions {
  double height = 2.5;  ///< [m] above the floor that is kept
  std::size_t max_voxels = 400'000'000;
};

/// The world of an octree: dense voxels at the tree's resolution from one voxel below the floor to
/// `height` above it; what the tree does not know stays kUnknown. The floor is the lowest voxel
/// layer that holds at least a quarter of the area of the layer with the most occupied voxels
/// covered by free ones (occupied, the voxel above free: a surface one can stand on); if the tree
/// has no such layer (floor never mapped), the lowest layer with at least half the free voxels of
/// the fullest layer lies just above it. The map is shifted down or up by whole voxels so that the
/// floor's surface is z = 0. start is left at the origin: see place_start.
///
/// Throws InputError if the tree has no free space or is larger than max_voxels.
World world_from_octree(const octomap::OcTree& tree, const std::string& name,
                        const OctreeWorldOptions& options = {});

}  // namespace prospect
