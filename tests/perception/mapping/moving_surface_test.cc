// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/moving_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace prospect::moving_surface_test {
namespace {

const PinholeCamera kCamera{100.0, 100.0, 79.5, 59.5, 160.0, 120.0};

/// A wall at 3 m, a person at 2 m in columns 16 to 23 of 40, who touches a shelf at 2.02 m in
/// columns 24 to 39, and a hole in row 10. The left part of the wall runs towards the camera, by 2
/// % a pixel.
struct Scene {
  DepthImage image{160, 120};
  PointLattice lattice{4, 40, 30, {}, {}};

  Scene() {
    for (int v = 0; v < 120; ++v) {
      for (int u = 0; u < 160; ++u) {
        const double z = u < 24 ? 3.0 * std::pow(0.98, 24 - u) : u < 64 ? 3.0 : u < 96 ? 2.0 : 2.02;
        image.at(u, v) = static_cast<float>(z);
        if (u % 4 != 2 || v % 4 != 2) continue;
        lattice.points.push_back(z * pixel_ray(kCamera, u, v));
        lattice.solid.push_back(v != 42);
      }
    }
  }
  const Eigen::Vector3d& at(int column, int row) const {
    return lattice.points[static_cast<std::size_t>(row * 40 + column)];
  }
};

TEST(MovingSurface, GrowsOverWhatMovesAndNotOverWhatRests) {
  const Scene scene;
  const auto at = [](int column, int row) { return static_cast<std::size_t>(row * 40 + column); };
  MotionInView motion;
  for (const int row : {4, 12, 20, 28}) {
    motion.moving.push_back(scene.at(20, row));
    motion.still.push_back(scene.at(30, row));
  }
  const std::vector<char> moves = moving_surface(kCamera, scene.image, scene.lattice, motion, 0.04);
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 40; ++column) {
      // The shelf is cut midway between what is known of either.
      if (column >= 23 && column <= 27) continue;
      EXPECT_EQ(static_cast<bool>(moves[at(column, row)]), row != 10 && column >= 16 && column < 24)
          << column << " " << row;
    }
  }
  EXPECT_FALSE(moves[at(28, 5)]);
  // A landmark that the image shows no more marks nothing.
  MotionInView gone;
  gone.moving.push_back(1.3 * scene.at(20, 4));
  gone.moving.push_back(-scene.at(20, 4));
  gone.moving.push_back({100.0, 0.0, 2.0});
  const std::vector<char> none = moving_surface(kCamera, scene.image, scene.lattice, gone, 0.04);
  EXPECT_EQ(std::count(none.begin(), none.end(), 1), 0);
}

TEST(MovingSurface, EndsAMetreFromTheLandmarkAlongASlantedWall) {
  const Scene scene;
  MotionInView motion;
  motion.moving.push_back(scene.at(1, 15));
  const std::vector<char> moves = moving_surface(kCamera, scene.image, scene.lattice, motion, 0.04);
  int wall = 0;
  for (std::size_t n = 0; n < moves.size(); ++n) {
    if (!moves[n]) continue;
    EXPECT_LE((scene.lattice.points[n] - motion.moving[0]).norm(), 1.0);
    EXPECT_LT(n % 40, std::size_t{16});
    ++wall;
  }
  EXPECT_GT(wall, 60);
}

}  // namespace
}  // namespace prospect::moving_surface_test
