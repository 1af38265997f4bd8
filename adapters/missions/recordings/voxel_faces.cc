// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/voxel_faces.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "adapters/views/page/binary_text.h"

namespace prospect {
namespace {

constexpr std::uint8_t kNoFace = 255;

std::array<int, 3> low_corner(const VoxelGrid& voxels) {
  return {voxels.frame().i0, voxels.frame().j0, voxels.k0()};
}

/// Occupancy levels of all voxels, in the order of VoxelGrid::data(); kNoFace: not occupied.
std::vector<std::uint8_t> occupancy_levels(const VoxelGrid& voxels, const octomap::OcTree& octree) {
  const std::array<int, 3> low = low_corner(voxels);
  std::vector<std::uint8_t> levels(voxels.data().size(), kNoFace);
  const double most = std::max(octree.getClampingThresMax(), 0.51);
  const int origin = 1 << (octree.getTreeDepth() - 1);
  std::size_t n = 0;
  for (int row = 0; row < voxels.frame().height; ++row) {
    for (int column = 0; column < voxels.frame().width; ++column) {
      for (int k = 0; k < voxels.depth(); ++k, ++n) {
        if (voxels.data()[n] != CellState::kOccupied) continue;
        const octomap::OcTreeKey key(static_cast<octomap::key_type>(low[0] + column + origin),
                                     static_cast<octomap::key_type>(low[1] + row + origin),
                                     static_cast<octomap::key_type>(low[2] + k + origin));
        const octomap::OcTreeNode* node = octree.search(key);
        const double share = node == nullptr ? 0.0 : (node->getOccupancy() - 0.5) / (most - 0.5);
        levels[n] = static_cast<std::uint8_t>(
            std::clamp(static_cast<int>(share * kOccupancyLevels), 0, kOccupancyLevels - 1));
      }
    }
  }
  return levels;
}

/// Takes the rectangles out of a layer's mask of levels, n_u columns and n_v rows.
template <typename Take>
void take_rectangles(std::vector<std::uint8_t>& mask, int n_u, int n_v, const Take& take) {
  const auto at = [&](int u, int v) -> std::uint8_t& {
    return mask[static_cast<std::size_t>(v) * static_cast<std::size_t>(n_u) +
                static_cast<std::size_t>(u)];
  };
  for (int v = 0; v < n_v; ++v) {
    for (int u = 0; u < n_u; ++u) {
      const std::uint8_t level = at(u, v);
      if (level == kNoFace) continue;
      int width = 1, height = 1;
      while (u + width < n_u && at(u + width, v) == level) ++width;
      const auto row_is = [&](int row) {
        for (int i = 0; i < width; ++i) {
          if (at(u + i, row) != level) return false;
        }
        return true;
      };
      while (v + height < n_v && row_is(v + height)) ++height;
      for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) at(u + i, v + j) = kNoFace;
      }
      take(u, v, width, height, level);
    }
  }
}

}  // namespace

std::vector<FaceRectangle> merged_faces(const VoxelGrid& voxels, const octomap::OcTree& octree) {
  const std::vector<std::uint8_t> levels = occupancy_levels(voxels, octree);
  const std::array<int, 3> low = low_corner(voxels);
  const std::array<int, 3> size = {voxels.frame().width, voxels.frame().height, voxels.depth()};
  const std::array<std::ptrdiff_t, 3> stride = {size[2],
                                                static_cast<std::ptrdiff_t>(size[2]) * size[0], 1};
  std::vector<FaceRectangle> faces;
  std::vector<std::uint8_t> mask;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis), b = (a + 1) % 3, c = (a + 2) % 3;
    for (const bool up : {false, true}) {
      for (int layer = 0; layer < size[a]; ++layer) {
        mask.assign(static_cast<std::size_t>(size[b]) * static_cast<std::size_t>(size[c]), kNoFace);
        const bool has_neighbour = up ? layer + 1 < size[a] : layer > 0;
        bool any = false;
        std::size_t n = 0;
        for (int v = 0; v < size[c]; ++v) {
          for (int u = 0; u < size[b]; ++u, ++n) {
            const std::ptrdiff_t at = layer * stride[a] + u * stride[b] + v * stride[c];
            const std::uint8_t level = levels[static_cast<std::size_t>(at)];
            if (level == kNoFace) continue;
            const std::ptrdiff_t beside = at + (up ? stride[a] : -stride[a]);
            if (has_neighbour && levels[static_cast<std::size_t>(beside)] != kNoFace) continue;
            mask[n] = level;
            any = true;
          }
        }
        if (!any) continue;
        take_rectangles(
            mask, size[b], size[c], [&](int u, int v, int width, int height, int level) {
              faces.push_back(
                  {axis, up, low[a] + layer + up, low[b] + u, low[c] + v, width, height, level});
            });
      }
    }
  }
  return faces;
}

std::string faces_text(const std::vector<FaceRectangle>& faces, const VoxelGrid& voxels) {
  const std::array<int, 3> low = low_corner(voxels);
  BinaryText text;
  std::size_t next = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (const bool up : {false, true}) {
      std::size_t end = next;
      while (end < faces.size() && faces[end].axis == axis && faces[end].up == up) ++end;
      text.add_varint(end - next);
      int layer = low[a];
      for (; next < end; ++next) {
        const FaceRectangle& f = faces[next];
        text.add_varint(static_cast<std::uint64_t>(f.layer - layer));
        text.add_varint(static_cast<std::uint64_t>(f.u - low[(a + 1) % 3]));
        text.add_varint(static_cast<std::uint64_t>(f.v - low[(a + 2) % 3]));
        text.add_varint(static_cast<std::uint64_t>((f.width - 1) * kOccupancyLevels + f.level));
        text.add_varint(static_cast<std::uint64_t>(f.height - 1));
        layer = f.layer;
      }
    }
  }
  return text.base64();
}

}  // namespace prospect
