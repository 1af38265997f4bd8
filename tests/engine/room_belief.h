// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <octomap/OcTree.h>

#include <cmath>
#include <memory>

#include "engine/maps/belief.h"
#include "engine/maps/map_projection.h"

namespace prospect::test {

/// What a robot knows that has seen the part x < `seen` of a room of 8 x 4 m: walls at x = -1 and
/// y = +-2, a box, and the space between; all from one octree, as a robot would hand it over.
struct Room {
  double seen = 3.0;    ///< [m]
  bool box = true;      ///< 0.5 x 0.8 m, one metre ahead of the origin and a bit to the right
  bool closed = false;  ///< a wall at x = seen: nothing is left to explore
  int landmarks_per_wall = 0;  ///< on both side walls

  std::shared_ptr<const octomap::OcTree> octree() const {
    auto tree = std::make_shared<octomap::OcTree>(0.1);
    for (int i = -10; (i + 0.5) * 0.1 < seen; ++i) {
      for (int j = -20; j < 20; ++j) {
        const double x = (i + 0.5) * 0.1, y = (j + 0.5) * 0.1;
        const bool wall = i == -10 || j == -20 || j == 19 || (closed && x > seen - 0.1);
        const bool inside = box && x > 1.2 && x < 1.7 && y > -0.7 && y < 0.1;
        for (int k = 0; k < 12; ++k) {
          tree->updateNode(octomap::point3d(static_cast<float>(x), static_cast<float>(y),
                                            static_cast<float>((k + 0.5) * 0.1)),
                           wall || inside);
        }
      }
    }
    return tree;
  }

  Belief belief() const {
    Belief b;
    const BeliefMaps maps = belief_maps(octree(), {0.1, 0.5}, 0.0, 1.2);
    b.octree = maps.octree;
    b.voxels = maps.voxels;
    b.ground = maps.ground;
    b.tracked_features = 4 * landmarks_per_wall;
    LandmarkMap map;
    for (int n = 0; n < 2 * landmarks_per_wall; ++n) {
      Landmark l;
      l.id = static_cast<std::uint64_t>(n + 1);
      const double along = (n / 2 + 0.5) / landmarks_per_wall;
      l.position = {-0.8 + along * (seen + 0.8), n % 2 == 0 ? 1.9 : -1.9, 0.3 + 0.1 * (n % 7)};
      l.creation_direction = (Eigen::Vector3d(0, 0, 0.45) - l.position).normalized();
      l.creation_range = (Eigen::Vector3d(0, 0, 0.45) - l.position).norm();
      map.landmarks.push_back(l);
    }
    b.landmarks = std::make_shared<const LandmarkMap>(std::move(map));
    return b;
  }
};

/// A belief of nothing: an empty octree and what is derived from it.
inline Belief empty_belief() {
  Belief b;
  const BeliefMaps maps =
      belief_maps(std::make_shared<const octomap::OcTree>(0.1), {0.1, 0.5}, 0.0, 1.2);
  b.octree = maps.octree;
  b.voxels = maps.voxels;
  b.ground = maps.ground;
  b.landmarks = std::make_shared<const LandmarkMap>();
  return b;
}

}  // namespace prospect::test
