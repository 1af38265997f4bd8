// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/maps/clearance_field.h"
#include "engine/maps/map_projection.h"

namespace prospect::test {

/// Maps for the tests of clearance: voxels and the ground map of the default slice.
struct ObstacleWorld {
  VoxelGrid voxels;
  GroundMap ground;

  /// All free within `half` metres of the origin, between the heights 0 and `top`.
  explicit ObstacleWorld(double resolution = 0.1, double half = 4.0, double top = 0.8)
      : voxels(frame(resolution, half), 0.0, top), ground(frame(resolution, half)) {
    const GridFrame f = frame(resolution, half);
    for (int n = 0; n < f.size(); ++n) {
      const Cell c = f.at(n);
      ground.set(c, CellState::kFree);
      for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
        voxels.set(c.i, c.j, k, CellState::kFree);
      }
    }
  }

  static GridFrame frame(double resolution, double half) {
    const int n = static_cast<int>(std::lround(half / resolution));
    return {resolution, -n, -n, 2 * n, 2 * n};
  }

  void occupy(int i, int j, int k) {
    voxels.set(i, j, k, CellState::kOccupied);
    const SliceLayers layers = slice_layers({}, voxels.resolution());
    if (k >= layers.k_low && k <= layers.k_high) ground.set({i, j}, CellState::kOccupied);
  }
  void occupy_column(int i, int j) {
    for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) occupy(i, j, k);
  }
  void forget_column(int i, int j) {
    for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
      voxels.set(i, j, k, CellState::kUnknown);
    }
    ground.set({i, j}, CellState::kUnknown);
  }

  Belief belief() const {
    Belief b;
    b.voxels = std::make_shared<const VoxelGrid>(voxels);
    b.ground = std::make_shared<const GroundMap>(ground);
    return b;
  }
};

/// Blocks, walls and single voxels at random.
inline ObstacleWorld random_world(std::uint64_t seed, double resolution = 0.1, double half = 4.0) {
  ObstacleWorld world(resolution, half);
  std::mt19937_64 random(seed);
  const int n = static_cast<int>(std::lround(half / resolution));
  std::uniform_int_distribution<int> place(-n, n - 1), size(1, std::max(1, n / 5)),
      layer(0, world.voxels.depth() - 1);
  for (int block = 0; block < 6; ++block) {
    const int i0 = place(random), j0 = place(random), wide = size(random), deep = size(random);
    for (int i = i0; i < std::min(n, i0 + wide); ++i) {
      for (int j = j0; j < std::min(n, j0 + deep); ++j) world.occupy_column(i, j);
    }
  }
  for (int wall = 0; wall < 4; ++wall) {
    const int i0 = place(random), j0 = place(random), length = 2 * size(random);
    for (int step = 0; step < length; ++step) {
      const int i = wall % 2 == 0 ? std::min(n - 1, i0 + step) : i0;
      const int j = wall % 2 == 0 ? j0 : std::min(n - 1, j0 + step);
      world.occupy_column(i, j);
    }
  }
  for (int speck = 0; speck < 12; ++speck) {
    world.occupy(place(random), place(random), world.voxels.k0() + layer(random));
  }
  return world;
}

/// The slow, obvious reference: the distance from a point to the nearest of a list of boxes.
struct Boxes {
  std::vector<Eigen::Vector3d> low, high;

  double distance(const Eigen::Vector3d& p, int dimensions) const {
    double nearest = 1e9;
    for (std::size_t n = 0; n < low.size(); ++n) {
      const Eigen::Vector3d gap = (low[n] - p).cwiseMax(p - high[n]).cwiseMax(0.0);
      nearest = std::min(nearest, gap.head(dimensions).norm());
    }
    return nearest;
  }
};

/// Boxes of the voxels that are obstacles (or, with complement, of those that are not) to a field
/// with these options, over the voxel grid widened by `widen` voxels.
inline Boxes boxes_of(const ObstacleWorld& world, const ClearanceField::Options& options,
                      bool complement = false, int widen = 12) {
  Boxes boxes;
  const VoxelGrid& v = world.voxels;
  const double r = v.resolution();
  const bool unknown = options.obstacles == ClearanceField::Obstacles::kOccupiedAndUnknown;
  const GridFrame& f = v.frame();
  for (int i = f.i0 - widen; i < f.i0 + f.width + widen; ++i) {
    for (int j = f.j0 - widen; j < f.j0 + f.height + widen; ++j) {
      if (options.vertical) {
        for (int k = v.k0() - widen; k < v.k0() + v.depth() + widen; ++k) {
          const CellState s = v.state(i, j, k);
          const bool solid = s == CellState::kOccupied || (unknown && s == CellState::kUnknown);
          if (solid == complement) continue;
          boxes.low.push_back(r * Eigen::Vector3d(i, j, k));
          boxes.high.push_back(r * Eigen::Vector3d(i + 1, j + 1, k + 1));
        }
        continue;
      }
      bool solid = unknown && world.ground.state({i, j}) == CellState::kUnknown;
      for (int k = v.k0(); k < v.k0() + v.depth(); ++k) {
        const bool overlaps =
            (k + 1) * r > options.slice.z_min + 1e-7 && k * r < options.slice.z_max - 1e-7;
        solid = solid || (overlaps && v.state(i, j, k) == CellState::kOccupied);
      }
      if (solid == complement) continue;
      boxes.low.push_back({r * i, r * j, options.slice.z_min});
      boxes.high.push_back({r * (i + 1), r * (j + 1), options.slice.z_max});
    }
  }
  return boxes;
}

}  // namespace prospect::test
