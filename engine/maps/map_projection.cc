// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/map_projection.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/maps/known_extent.h"

namespace prospect {
namespace {

// OctoMap's key of the voxel that starts at the origin: keys are addresses plus this.
constexpr int kKeyOrigin = 32768;

struct LeafBox {
  int low[3];
  int size;
};

template <typename Iterator>
LeafBox leaf_box(const Iterator& leaf, unsigned tree_depth) {
  const int size = 1 << (tree_depth - leaf.getDepth());
  const octomap::OcTreeKey& key = leaf.getKey();
  LeafBox box{};
  box.size = size;
  for (unsigned a = 0; a < 3; ++a) {
    // The key of a pruned leaf is that of its centre; its low corner is the multiple of its size.
    box.low[a] = (static_cast<int>(key[a]) & ~(size - 1)) - kKeyOrigin;
  }
  return box;
}

}  // namespace

HeightSlice height_slice(const RobotDescription& robot) {
  const VerticalExtent slice = robot.slice();
  return {slice.z_min, slice.z_max, robot.base_height() + robot.depth_mount.T_BC.translation().z()};
}

SliceLayers slice_layers(const HeightSlice& slice, double resolution) {
  if (!std::isfinite(slice.z_min) || !std::isfinite(slice.z_max) || !(slice.z_min < slice.z_max)) {
    throw std::invalid_argument("height slice [" + std::to_string(slice.z_min) + ", " +
                                std::to_string(slice.z_max) + "] m: expected z_min < z_max");
  }
  if (slice.sight && !std::isfinite(*slice.sight)) {
    throw std::invalid_argument("line of sight " + std::to_string(*slice.sight) +
                                " m: expected a finite height");
  }
  if (!std::isfinite(resolution) || !(resolution > 0.0)) {
    throw std::invalid_argument("resolution " + std::to_string(resolution) +
                                " m: expected a positive number");
  }
  if (!(slice.step >= 0.0)) {
    throw std::invalid_argument("step of the floor " + std::to_string(slice.step) +
                                " m: expected a height of at least 0");
  }
  // Heights on a face of the lattice are not exact multiples in floating point: 0.3 - 0.2 < 0.1.
  constexpr double kOverlap = 1e-6;
  SliceLayers layers;
  layers.k_low = static_cast<int>(std::floor((slice.z_min + kOverlap) / resolution));
  layers.k_high = static_cast<int>(std::ceil((slice.z_max - kOverlap) / resolution)) - 1;
  layers.k_high = std::max(layers.k_high, layers.k_low);
  if (slice.sight) {
    layers.k_sight = static_cast<int>(std::floor((*slice.sight + kOverlap) / resolution));
  }
  layers.floor = {floor_layer(slice.step, resolution), std::max(layers.k_low, 0)};
  return layers;
}

CellState project_column(const VoxelGrid& voxels, Cell c, const SliceLayers& layers) {
  int occupied = 0;
  int free = 0;
  for (int k = layers.k_low; k <= layers.k_high; ++k) {
    const CellState s = voxels.state(c.i, c.j, k);
    occupied += s == CellState::kOccupied;
    free += s == CellState::kFree;
  }
  return project_column(occupied, free, floor_state(voxels, c, layers.floor));
}

bool see_through(const VoxelGrid& voxels, Cell c, const SliceLayers& layers) {
  const CellState column = project_column(voxels, c, layers);
  return see_through(column, layers.k_sight ? voxels.state(c.i, c.j, *layers.k_sight) : column);
}

GroundMap project(const VoxelGrid& voxels, const HeightSlice& slice, int rim) {
  const SliceLayers layers = slice_layers(slice, voxels.resolution());
  const GridFrame& frame = voxels.frame();
  GroundMap ground({frame.resolution, frame.i0 - rim, frame.j0 - rim, frame.width + 2 * rim,
                    frame.height + 2 * rim});
  for (int j = frame.j0; j < frame.j0 + frame.height; ++j) {
    for (int i = frame.i0; i < frame.i0 + frame.width; ++i) {
      ground.set({i, j}, project_column(voxels, {i, j}, layers),
                 see_through(voxels, {i, j}, layers));
    }
  }
  return ground;
}

VoxelGrid voxels_from_octree(const octomap::OcTree& octree, double z_min, double z_max,
                             int max_cells) {
  if (!std::isfinite(z_min) || !std::isfinite(z_max) || !(z_min < z_max)) {
    throw std::invalid_argument("heights [" + std::to_string(z_min) + ", " + std::to_string(z_max) +
                                "] m of the voxel grid: expected z_min < z_max");
  }
  const double r = octree.getResolution();
  const unsigned depth = octree.getTreeDepth();
  VoxelGrid probe({r, 0, 0, 1, 1}, z_min, z_max);
  const int k_low = probe.k0();
  const int k_end = k_low + probe.depth();

  KnownExtent extent;
  for (auto leaf = octree.begin_leafs(), end = octree.end_leafs(); leaf != end; ++leaf) {
    const LeafBox box = leaf_box(leaf, depth);
    if (box.low[2] >= k_end || box.low[2] + box.size <= k_low) continue;
    extent.add(box.low[0], box.low[1], box.low[0] + box.size - 1, box.low[1] + box.size - 1);
  }
  const GridFrame frame = extent.frame(r);
  if (frame.width == 0) return probe;
  const std::int64_t cells = std::int64_t{frame.width} * frame.height;
  if (cells > max_cells) {
    throw std::invalid_argument("octree covers " + std::to_string(cells) +
                                " ground cells: expected at most " + std::to_string(max_cells));
  }
  VoxelGrid voxels(frame, z_min, z_max);
  for (auto leaf = octree.begin_leafs(), end = octree.end_leafs(); leaf != end; ++leaf) {
    const LeafBox box = leaf_box(leaf, depth);
    const CellState state = octree.isNodeOccupied(*leaf) ? CellState::kOccupied : CellState::kFree;
    const int k_from = std::max(box.low[2], k_low);
    const int k_to = std::min(box.low[2] + box.size, k_end);
    if (k_from >= k_to) continue;
    const GridFrame leaf_cells =
        intersection(frame, {r, box.low[0], box.low[1], box.size, box.size});
    for (int j = leaf_cells.j0; j < leaf_cells.j0 + leaf_cells.height; ++j) {
      for (int i = leaf_cells.i0; i < leaf_cells.i0 + leaf_cells.width; ++i) {
        for (int k = k_from; k < k_to; ++k) voxels.set(i, j, k, state);
      }
    }
  }
  return voxels;
}

BeliefMaps belief_maps(std::shared_ptr<const octomap::OcTree> octree, const HeightSlice& slice,
                       double z_min, double z_max) {
  if (!octree) throw std::invalid_argument("belief maps: expected an octree, got none");
  BeliefMaps maps;
  auto voxels = std::make_shared<VoxelGrid>(voxels_from_octree(*octree, z_min, z_max));
  maps.ground = std::make_shared<GroundMap>(project(*voxels, slice, GroundMap::kTile));
  maps.voxels = std::move(voxels);
  maps.octree = std::move(octree);
  return maps;
}

}  // namespace prospect
