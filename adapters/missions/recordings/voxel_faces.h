// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "engine/maps/voxel_grid.h"

namespace octomap {
class OcTree;
}

namespace prospect {

/// A rectangle of faces, all of occupied voxels with the same neighbour on that side: none that is
/// occupied. In voxels of the grid: along `axis` (0 x, 1 y, 2 z) at the plane `layer`, from (u, v)
/// on over width x height voxels along the next two axes, in the order x y z x y.
struct FaceRectangle {
  int axis = 0;
  bool up = false;  ///< the free side is that of larger coordinates
  int layer = 0, u = 0, v = 0, width = 1, height = 1;
  int level = 0;  ///< of occupancy, 0 to kOccupancyLevels - 1
};

/// Levels divide the probabilities from 0.5 to the tree's upper bound evenly.
inline constexpr int kOccupancyLevels = 4;

/// What can be seen of the occupied voxels, merged into few rectangles: along u as far as it goes,
/// then along v. By axis, side, layer, v and u. Every exposed face is in exactly one of them.
/// O(cells of the grid). Pure function.
std::vector<FaceRectangle> merged_faces(const VoxelGrid& voxels, const octomap::OcTree& octree);

/// The rectangles as base64 for a page. For each axis and side, (x down, x up, y down, ...): how
/// many, and of each the step from the layer before, u, v, and width - 1 times kOccupancyLevels
/// plus level, height - 1, all as BinaryText's varints; u and v and layer from the grid's lowest
/// corner.
std::string faces_text(const std::vector<FaceRectangle>& faces, const VoxelGrid& voxels);

}  // namespace prospect
