// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "engine/maps/belief.h"
#include "engine/maps/map_projection.h"

namespace prospect::test {

/// Rooms of 6 m with doors, each fifth of them unknown; `shift` cells further along both axes.
inline void give_rooms(Belief& belief, double side, int shift = 0) {
  const int n = static_cast<int>(std::lround(10.0 * side));
  auto voxels = std::make_shared<VoxelGrid>(GridFrame{0.1, shift - 10, shift - 10, n, n}, 0.0, 0.6);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      if ((i / 60 + j / 60) % 5 == 4) continue;
      const bool rim = i == 0 || j == 0 || i == n - 1 || j == n - 1;
      const bool wall = rim || (i % 60 == 0 && j % 60 > 14) || (j % 60 == 0 && i % 60 > 14);
      for (int k = 0; k < 6; ++k) {
        voxels->set(i + shift - 10, j + shift - 10, k,
                    wall ? CellState::kOccupied : CellState::kFree);
      }
    }
  }
  belief.ground = std::make_shared<const GroundMap>(project(*voxels, {0.1, 0.5}, 16));
  belief.voxels = std::move(voxels);
}

inline std::shared_ptr<const LandmarkMap> landmarks_about(int count) {
  auto map = std::make_shared<LandmarkMap>();
  for (int n = 0; n < count; ++n) {
    Landmark l;
    l.id = static_cast<std::uint64_t>(n + 1);
    const double angle = 2.4 * n, distance = 1.0 + std::fmod(0.37 * n, 10.0);
    l.position = {2.0 + distance * std::cos(angle), 2.0 + distance * std::sin(angle),
                  0.2 + 0.008 * (n % 100)};
    l.creation_direction = -Eigen::Vector3d::UnitX();
    map->landmarks.push_back(l);
  }
  return map;
}

}  // namespace prospect::test
