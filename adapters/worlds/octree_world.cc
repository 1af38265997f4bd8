#include "adapters/worlds/octree_world.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "adapters/config/input_error.h"

namespace prospect {
namespace {

constexpr int kKeyOfZero = 32768;  // the library's key of voxel 0

struct VoxelBox {
  Eigen::Array3i low, high;  ///< voxels, high exclusive
};

template <typename Visit>
void for_each_leaf(const octomap::OcTree& tree, Visit visit) {
  for (auto it = tree.begin_leafs(), end = tree.end_leafs(); it != end; ++it) {
    const octomap::OcTreeKey key = it.getIndexKey();
    const int size = 1 << (tree.getTreeDepth() - it.getDepth());
    const Eigen::Array3i low(key[0] - kKeyOfZero, key[1] - kKeyOfZero, key[2] - kKeyOfZero);
    visit(VoxelBox{low, low + size}, tree.isNodeOccupied(*it));
  }
}

/// Layer of the lowest voxels above the floor, relative to the box.
int first_layer_above_floor(const std::vector<CellState>& dense, std::size_t columns, int depth) {
  std::vector<std::size_t> free(static_cast<std::size_t>(depth), 0);
  std::vector<std::size_t> surface(static_cast<std::size_t>(depth), 0);
  for (std::size_t c = 0; c < columns; ++c) {
    const CellState* column = dense.data() + c * static_cast<std::size_t>(depth);
    for (int k = 0; k < depth; ++k) {
      if (column[k] == CellState::kFree) ++free[static_cast<std::size_t>(k)];
      if (column[k] == CellState::kOccupied && k + 1 < depth && column[k + 1] == CellState::kFree) {
        ++surface[static_cast<std::size_t>(k)];
      }
    }
  }
  const std::size_t fullest = *std::max_element(free.begin(), free.end());
  const auto floor = std::max_element(surface.begin(), surface.end());
  if (10 * *floor >= fullest) return static_cast<int>(floor - surface.begin()) + 1;
  return static_cast<int>(
      std::find_if(free.begin(), free.end(), [&](std::size_t n) { return 2 * n >= fullest; }) -
      free.begin());
}

/// Sets the pockets of a box of voxels (z fastest, then x, then y) to free.
void fill_pockets(std::vector<CellState>& dense, const Eigen::Array3i& size, std::size_t largest) {
  enum : std::uint8_t { kNew, kOpenSpace, kThisPocket };
  std::vector<std::uint8_t> mark(dense.size(), kNew);
  const auto depth = static_cast<std::size_t>(size[2]);
  const auto row = depth * static_cast<std::size_t>(size[0]);
  std::vector<std::size_t> pocket;
  for (std::size_t seed = 0; seed < dense.size(); ++seed) {
    // Every pocket has a voxel above a free one.
    if (dense[seed] != CellState::kUnknown || mark[seed] != kNew) continue;
    if (seed % depth == 0 || dense[seed - 1] != CellState::kFree) continue;
    pocket.assign(1, seed);
    mark[seed] = kThisPocket;
    bool closed = true;
    for (std::size_t n = 0; n < pocket.size() && closed; ++n) {
      const std::size_t at = pocket[n];
      const auto k = static_cast<int>(at % depth);
      const auto i = static_cast<int>(at % row / depth);
      const auto j = static_cast<int>(at / row);
      const bool border =
          i == 0 || j == 0 || k == 0 || i + 1 == size[0] || j + 1 == size[1] || k + 1 == size[2];
      if (border || pocket.size() > largest) {
        closed = false;
        break;
      }
      for (const std::size_t next : {at - 1, at + 1, at - depth, at + depth, at - row, at + row}) {
        if (dense[next] == CellState::kFree || mark[next] == kThisPocket) continue;
        if (dense[next] == CellState::kOccupied || mark[next] == kOpenSpace) {
          closed = false;
          break;
        }
        mark[next] = kThisPocket;
        pocket.push_back(next);
      }
    }
    for (const std::size_t at : pocket) {
      if (closed) {
        dense[at] = CellState::kFree;
      } else {
        mark[at] = kOpenSpace;
      }
    }
  }
}

/// Merges voxels; the floor stays the layer just below z = 0.
World merged(World world, double resolution) {
  const VoxelGrid& fine = world.voxels;
  const double r = fine.resolution();
  const int factor = static_cast<int>(std::floor(resolution / r + 1e-6));
  if (factor < 2) return world;
  const GridFrame& f = fine.frame();
  const GridFrame frame = frame_of_blocks(f, factor);
  const int top = floor_divide(fine.k0() + fine.depth() - 1, factor);
  VoxelGrid coarse(frame, -0.5 * frame.resolution, (top + 0.5) * frame.resolution);
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    bool any_free = false;
    for (int k = 0; k <= top; ++k) {
      int occupied = 0, free = 0, inside = 0;
      for (int dj = 0; dj < factor; ++dj) {
        for (int di = 0; di < factor; ++di) {
          for (int dk = 0; dk < factor; ++dk) {
            const int i = c.i * factor + di, j = c.j * factor + dj, l = k * factor + dk;
            inside += fine.contains(i, j, l);
            const CellState state = fine.state(i, j, l);
            occupied += state == CellState::kOccupied;
            free += state == CellState::kFree;
          }
        }
      }
      if (occupied > 0) coarse.set(c.i, c.j, k, CellState::kOccupied);
      if (occupied == 0 && free > 0 && 2 * free >= inside) {
        coarse.set(c.i, c.j, k, CellState::kFree);
        any_free = any_free || k == 0;
      }
    }
    if (any_free) coarse.set(c.i, c.j, -1, CellState::kOccupied);
  }
  world.voxels = std::move(coarse);
  return world;
}

}  // namespace

World world_from_octree(const octomap::OcTree& tree, const std::string& name,
                        const OctreeWorldOptions& options) {
  constexpr int kMax = std::numeric_limits<int>::max();
  VoxelBox box{Eigen::Array3i::Constant(kMax), Eigen::Array3i::Constant(-kMax)};
  bool any_free = false;
  for_each_leaf(tree, [&](const VoxelBox& leaf, bool occupied) {
    box.low = box.low.min(leaf.low);
    box.high = box.high.max(leaf.high);
    any_free = any_free || !occupied;
  });
  if (!any_free) {
    throw InputError(name + ": the octree has no free space; expected a map with free voxels");
  }
  const Eigen::Array3i size = box.high - box.low;
  const std::size_t columns = static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  const int depth = size[2];
  if (columns > options.max_voxels / static_cast<std::size_t>(depth)) {
    throw InputError(name + ": " + std::to_string(size[0]) + " x " + std::to_string(size[1]) +
                     " x " + std::to_string(depth) + " voxels; expected at most " +
                     std::to_string(options.max_voxels) + " in all");
  }
  std::vector<CellState> dense(columns * static_cast<std::size_t>(depth), CellState::kUnknown);
  for_each_leaf(tree, [&](const VoxelBox& leaf, bool occupied) {
    const CellState state = occupied ? CellState::kOccupied : CellState::kFree;
    const Eigen::Array3i low = leaf.low - box.low, high = leaf.high - box.low;
    for (int j = low[1]; j < high[1]; ++j) {
      for (int i = low[0]; i < high[0]; ++i) {
        const std::size_t column = static_cast<std::size_t>(j) * static_cast<std::size_t>(size[0]) +
                                   static_cast<std::size_t>(i);
        const auto begin =
            dense.begin() + static_cast<std::ptrdiff_t>(column * static_cast<std::size_t>(depth));
        std::fill(begin + low[2], begin + high[2], state);
      }
    }
  });

  const double voxel_volume = std::pow(tree.getResolution(), 3);
  fill_pockets(dense, size,
               static_cast<std::size_t>(std::max(0.0, options.max_pocket) / voxel_volume));

  const int floor = first_layer_above_floor(dense, columns, depth);
  const double r = tree.getResolution();
  const int layers = std::min(std::max(1, static_cast<int>(std::ceil(options.height / r - 1e-9))),
                              std::max(1, depth - floor));
  GridFrame frame{r, box.low[0], box.low[1], size[0], size[1]};
  // Half a voxel inside the layers that are meant, so that rounding outward adds none.
  World world{name, VoxelGrid(frame, -0.5 * r, (layers - 0.5) * r), {}, {}, {}, 0.0};
  world.source_floor_height = (box.low[2] + floor) * r;
  for (int j = 0; j < size[1]; ++j) {
    for (int i = 0; i < size[0]; ++i) {
      const CellState* column =
          dense.data() + (static_cast<std::size_t>(j) * static_cast<std::size_t>(size[0]) +
                          static_cast<std::size_t>(i)) *
                             static_cast<std::size_t>(depth);
      const int x = box.low[0] + i, y = box.low[1] + j;
      for (int k = -1; k < layers; ++k) {
        const int source = floor + k;
        if (source < 0 || source >= depth) continue;
        world.voxels.set(x, y, k, column[source]);
      }
      if (floor < depth && column[floor] == CellState::kFree) {
        world.voxels.set(x, y, -1, CellState::kOccupied);
      }
    }
  }
  return merged(std::move(world), options.resolution);
}

}  // namespace prospect
