// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>

#include "adapters/formats/worlds/world.h"

namespace prospect::test {

/// A room [0, length] x [0, width] x [0, height] m with walls, floor and ceiling one voxel thick,
/// of one texture density, and the robot in its middle.
inline World box_room(double length, double width, double height = 2.0, double resolution = 0.1,
                      double density = 30.0) {
  const int nx = static_cast<int>(std::lround(length / resolution));
  const int ny = static_cast<int>(std::lround(width / resolution));
  const int nz = static_cast<int>(std::lround(height / resolution));
  World world{
      .name = "box",
      .voxels = VoxelGrid({resolution, -1, -1, nx + 2, ny + 2}, -resolution, (nz + 1) * resolution),
      .start = {},
      .texture_density = {density},
      .texture_class = {}};
  for (int j = -1; j <= ny; ++j) {
    for (int i = -1; i <= nx; ++i) {
      for (int k = -1; k <= nz; ++k) {
        const bool inside = i >= 0 && i < nx && j >= 0 && j < ny && k >= 0 && k < nz;
        world.voxels.set(i, j, k, inside ? CellState::kFree : CellState::kOccupied);
      }
    }
  }
  world.texture_class.assign(world.voxels.data().size(), 0);
  world.start.position = {0.5 * length, 0.5 * width, 0.0};
  return world;
}

/// Fills the voxels whose centres lie in a box.
inline void fill(World& world, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                 CellState state = CellState::kOccupied) {
  const double r = world.voxels.resolution();
  const GridFrame f = world.voxels.frame();
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    for (int i = f.i0; i < f.i0 + f.width; ++i) {
      for (int k = world.voxels.k0(); k < world.voxels.k0() + world.voxels.depth(); ++k) {
        const Eigen::Vector3d c = (Eigen::Vector3d(i, j, k).array() + 0.5).matrix() * r;
        if ((c.array() >= low.array()).all() && (c.array() <= high.array()).all()) {
          world.voxels.set(i, j, k, state);
        }
      }
    }
  }
}

/// A room 4 m wide, textured up to x = textured [m], white beyond; the robot looks into it.
inline std::shared_ptr<World> half_white_room(double length, double textured) {
  auto world = std::make_shared<World>(box_room(length, 4.0, 2.2, 0.1));
  world->texture_density = {40.0, 0.0};
  const GridFrame f = world->voxels.frame();
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    for (int i = static_cast<int>(std::lround(textured / 0.1)); i < f.i0 + f.width; ++i) {
      for (int k = world->voxels.k0(); k < world->voxels.k0() + world->voxels.depth(); ++k) {
        world->texture_class[world->voxels.index(i, j, k)] = 1;
      }
    }
  }
  world->start.position = {1.0, 2.0, 0.0};
  return world;
}

}  // namespace prospect::test
