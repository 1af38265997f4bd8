// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/octree_world.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/left_out.h"

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

/// The box of the part with the most free voxels, as world_from_octree() says; `whole` if that is
/// not much smaller. Blocks of which less than `least` is known connect nothing.
VoxelBox connected_box(const octomap::OcTree& tree, const VoxelBox& whole, double least,
                       LeftOut& left_out) {
  constexpr double kBlock = 1.0;       // [m]
  constexpr double kMostBlocks = 5e6;  // of all leaves
  constexpr int kOffset = 1 << 20;
  const int side = std::max(1, static_cast<int>(std::lround(kBlock / tree.getResolution())));
  const auto block_of = [&](const Eigen::Array3i& voxel) {
    return Eigen::Array3i(floor_divide(voxel[0], side), floor_divide(voxel[1], side),
                          floor_divide(voxel[2], side));
  };
  const auto key_of = [&](const Eigen::Array3i& block) {
    const auto part = [](int x) { return static_cast<std::uint64_t>(x + kOffset); };
    return part(block[0]) << 42 | part(block[1]) << 21 | part(block[2]);
  };
  double blocks = 0.0;
  for_each_leaf(tree, [&](const VoxelBox& leaf, bool) {
    blocks += (block_of(leaf.high - 1) - block_of(leaf.low) + 1).cast<double>().prod();
  });
  if (blocks > kMostBlocks) return whole;
  struct Block {
    Eigen::Array3i at;
    double free = 0.0, known = 0.0;  // voxels
    int part = -1;
  };
  std::unordered_map<std::uint64_t, Block> all;
  for_each_leaf(tree, [&](const VoxelBox& leaf, bool occupied) {
    const Eigen::Array3i low = block_of(leaf.low), high = block_of(leaf.high - 1);
    const double share =
        (leaf.high - leaf.low).cast<double>().prod() / (high - low + 1).cast<double>().prod();
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int z = low[2]; z <= high[2]; ++z) {
          const Eigen::Array3i at(x, y, z);
          Block& block = all[key_of(at)];
          block.at = at;
          block.known += share;
          if (!occupied) block.free += share;
        }
      }
    }
  });
  std::erase_if(all, [&](const auto& block) {
    return block.second.known < least * static_cast<double>(side) * side * side;
  });
  int parts = 0, main = 0;
  double most = -1.0;
  std::vector<Block*> open;
  for (auto& [key, first] : all) {
    if (first.part >= 0) continue;
    const int part = parts++;
    double free = 0.0;
    first.part = part;
    open.assign(1, &first);
    while (!open.empty()) {
      const Block& block = *open.back();
      open.pop_back();
      free += block.free;
      for (int n = 0; n < 27; ++n) {
        const Eigen::Array3i next = block.at + Eigen::Array3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        const auto found = all.find(key_of(next));
        if (found == all.end() || found->second.part >= 0) continue;
        found->second.part = part;
        open.push_back(&found->second);
      }
    }
    if (free > most) {
      most = free;
      main = part;
    }
  }
  if (parts == 0) return whole;
  constexpr int kMax = std::numeric_limits<int>::max();
  VoxelBox box{Eigen::Array3i::Constant(kMax), Eigen::Array3i::Constant(-kMax)};
  for_each_leaf(tree, [&](const VoxelBox& leaf, bool) {
    const auto block = all.find(key_of(block_of(leaf.low)));
    if (block == all.end() || block->second.part != main) return;
    box.low = box.low.min(leaf.low);
    box.high = box.high.max(leaf.high);
  });
  const auto volume = [](const VoxelBox& b) { return (b.high - b.low).cast<double>().prod(); };
  if (2.0 * volume(box) > volume(whole)) return whole;
  double voxels = 0.0, farthest = 0.0;
  for_each_leaf(tree, [&](const VoxelBox& leaf, bool) {
    const Eigen::Array3i off = (box.low - leaf.high).max(leaf.low - box.high).max(0);
    const bool inside = (leaf.low >= box.low).all() && (leaf.high <= box.high).all();
    if (inside) return;
    voxels += (leaf.high - leaf.low).cast<double>().prod();
    farthest = std::max(farthest, off.matrix().cast<double>().norm() * tree.getResolution());
  });
  const auto count = static_cast<std::size_t>(voxels);
  left_out.name(std::to_string(count) + (count == 1 ? " voxel" : " voxels") + " up to " +
                metres(farthest) +
                (least > 0.0 ? " m off, which thin rays connect to the rest"
                             : " m off, which nothing connects to the rest"));
  return box;
}

struct OctreeFloor {
  int layer = 0;  ///< of the lowest voxels above the floor, relative to the box
  double share = std::numeric_limits<double>::quiet_NaN();  ///< World::floor_share
};

/// The floor, as world_from_octree() says. The box begins at the voxel `lowest`.
OctreeFloor octree_floor(const std::vector<CellState>& dense, std::size_t columns, int depth,
                         int lowest, double resolution, const std::optional<double>& wanted,
                         const std::string& name) {
  std::vector<std::size_t> free(static_cast<std::size_t>(depth), 0);
  std::vector<std::size_t> surface(static_cast<std::size_t>(depth), 0);
  std::size_t ground = 0;  // surface voxels with room for a robot above
  const int room = std::max(1, static_cast<int>(std::lround(0.5 / resolution)));
  for (std::size_t c = 0; c < columns; ++c) {
    const CellState* column = dense.data() + c * static_cast<std::size_t>(depth);
    for (int k = 0; k < depth; ++k) {
      if (column[k] == CellState::kFree) ++free[static_cast<std::size_t>(k)];
      if (column[k] == CellState::kOccupied && k + 1 < depth && column[k + 1] == CellState::kFree) {
        ++surface[static_cast<std::size_t>(k)];
        int clear = 1;
        while (clear < room && k + 1 + clear < depth && column[k + 1 + clear] == CellState::kFree) {
          ++clear;
        }
        ground += clear == room;
      }
    }
  }
  const auto layers_in = [&](double length) {
    return std::max(1, static_cast<int>(std::lround(length / resolution)));
  };
  /// [m] of the upper side of layer k.
  const auto height = [&](std::ptrdiff_t k) {
    return (lowest + static_cast<double>(k) + 1.0) * resolution;
  };
  const std::size_t fullest = *std::max_element(free.begin(), free.end());
  auto floor = std::max_element(surface.begin(), surface.end());
  bool mapped = 10 * *floor >= fullest;
  if (wanted) {
    constexpr double kFarthest = 0.5;  // [m]
    std::string heights;
    auto best = surface.end();
    int lowest_free = -1;
    std::size_t largest = 0;  // so near
    for (int k = 0; k < depth; ++k) {
      const auto n = static_cast<std::size_t>(k);
      if (surface[n] >= std::max<std::size_t>(1, *floor / 5) && heights.size() < 100) {
        heights += (heights.empty() ? "" : ", ") + metres(height(k));
      }
      if (lowest_free < 0 && 2 * free[n] >= fullest &&
          std::abs(height(k - 1) - *wanted) <= kFarthest) {
        lowest_free = k;
      }
      if (std::abs(height(k) - *wanted) <= kFarthest) largest = std::max(largest, surface[n]);
    }
    double nearest = kFarthest;
    for (int k = 0; k < depth; ++k) {
      const std::size_t n = surface[static_cast<std::size_t>(k)];
      const double off = std::abs(height(k) - *wanted);
      if (n == 0 || off > nearest || 2 * n < largest || 20 * n < *floor) continue;
      nearest = off;
      best = surface.begin() + k;
    }
    if (best == surface.end() && !mapped && lowest_free >= 0) return {lowest_free};
    if (best == surface.end()) {
      throw InputError(name + ": no ground within 0.5 m of z = " + metres(*wanted) +
                       " m; expected one of the heights " +
                       (heights.empty() ? "of its free space" : heights + " m"));
    }
    floor = best;
    mapped = true;
  }
  // Ground on many heights, of which none has much, is not a floor that was not mapped.
  constexpr double kMuchGround = 0.5;  // of the fullest layer's free voxels
  const bool hilly =
      !mapped && static_cast<double>(ground) > kMuchGround * static_cast<double>(fullest);
  if (!mapped && !hilly) {
    return {static_cast<int>(
        std::find_if(free.begin(), free.end(), [&](std::size_t n) { return 2 * n >= fullest; }) -
        free.begin())};
  }
  const std::ptrdiff_t at = floor - surface.begin();
  std::size_t on_floor = 0, around = 0, total = 0;
  for (std::ptrdiff_t k = 0; k < depth; ++k) {
    const std::size_t n = surface[static_cast<std::size_t>(k)];
    total += n;
    if (std::abs(k - at) <= layers_in(1.0)) around += n;
    if (std::abs(k - at) <= layers_in(0.1)) on_floor += n;
  }
  const double flat =
      static_cast<double>(on_floor) / static_cast<double>(std::max<std::size_t>(around, 1));
  constexpr double kLeast = 0.25;
  if (!wanted && (hilly || flat < kLeast)) {
    throw InputError(name + ": the ground is not flat: only " + metres(100.0 * flat) +
                     " % of it is within 0.1 m of z = " + metres(height(at)) +
                     " m; expected a flat floor, or --floor with the height to explore at");
  }
  return {static_cast<int>(at) + 1, static_cast<double>(on_floor) / static_cast<double>(total)};
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
  if (!any_free && !(options.unknown_is_free && tree.size() > 0)) {
    throw InputError(name +
                     ": the octree has no free space; expected a map with free voxels, or "
                     "--unknown free");
  }
  LeftOut left_out;
  box = connected_box(tree, box, 0.0, left_out);
  // A false reading far off comes with the ray that leads there.
  constexpr double kLarge = 5e7;     // voxels; what can be afforded is not cut
  constexpr double kRayFill = 0.03;  // of a block
  if ((box.high - box.low).cast<double>().prod() > kLarge) {
    box = connected_box(tree, box, kRayFill, left_out);
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
    const Eigen::Array3i low = (leaf.low - box.low).max(0), high = (leaf.high - box.low).min(size);
    if ((low >= high).any()) return;
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

  if (options.unknown_is_free) {
    std::replace(dense.begin(), dense.end(), CellState::kUnknown, CellState::kFree);
  }
  const double voxel_volume = std::pow(tree.getResolution(), 3);
  fill_pockets(dense, size,
               static_cast<std::size_t>(std::max(0.0, options.max_pocket) / voxel_volume));

  const double r = tree.getResolution();
  const OctreeFloor ground =
      octree_floor(dense, columns, depth, box.low[2], r, options.ground, name);
  const int floor = ground.layer;
  const int layers = std::min(std::max(1, static_cast<int>(std::ceil(options.height / r - 1e-9))),
                              std::max(1, depth - floor));
  GridFrame frame{r, box.low[0], box.low[1], size[0], size[1]};
  // Half a voxel inside the layers that are meant, so that rounding outward adds none.
  World world{name, VoxelGrid(frame, -0.5 * r, (layers - 0.5) * r), {}, {}, {}, 0.0};
  world.source_floor_height = (box.low[2] + floor) * r;
  world.left_out = std::move(left_out);
  world.floor_share = ground.share;
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
