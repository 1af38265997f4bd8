// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/wall_thickness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prospect::wall_thickness_test {
namespace {

constexpr double kR = 0.05;

/// A wall 2 m high, from `from` on `length` [m] in direction `angle`, one voxel thick, into a grid.
void add_wall(VoxelGrid& grid, const Eigen::Vector2d& from, double angle, double length) {
  for (double s = 0.0; s <= length; s += 0.2 * kR) {
    const Eigen::Vector2d p = from + s * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Cell c = grid.frame().cell(p.x(), p.y());
    for (int k = 0; k < 40; ++k) grid.set(c.i, c.j, k, CellState::kOccupied);
  }
}

VoxelGrid empty() { return {GridFrame{kR, -60, -60, 120, 120}, 0.0, 2.5}; }

TEST(WallThickness, OfASingleWallAtAnyAngle) {
  for (double angle = 0.0; angle < 3.0; angle += 0.17) {
    VoxelGrid grid = empty();
    add_wall(grid, {0.013, 0.027}, angle, 2.0);
    const WallThickness t = wall_thickness(grid);
    EXPECT_GT(t.cells, 35) << angle;
    EXPECT_GE(t.median, kR - 1e-9) << angle;
    EXPECT_LE(t.median, 2.5 * kR + 1e-9) << angle;
    EXPECT_EQ(t.doubled, 0.0) << angle;
  }
}

TEST(WallThickness, OfADoubledWall) {
  for (const double off : {0.1, 0.15, 0.2}) {
    for (double angle = 0.0; angle < 3.0; angle += 0.31) {
      VoxelGrid grid = empty();
      add_wall(grid, {0.013, 0.027}, angle, 2.0);
      add_wall(grid, Eigen::Vector2d(0.013 - off * std::sin(angle), 0.027 + off * std::cos(angle)),
               angle, 2.0);
      const WallThickness t = wall_thickness(grid);
      EXPECT_GE(t.median, off + kR - 1e-9) << off << " " << angle;
      EXPECT_LE(t.median, off + 2.5 * kR + 1e-9) << off << " " << angle;
      EXPECT_GT(t.doubled, off > 0.1 ? 0.9 : 0.2) << off << " " << angle;
    }
  }
}

TEST(WallThickness, OfTwoWallsFarApartIsThatOfEach) {
  VoxelGrid grid = empty();
  add_wall(grid, {0.0, 0.0}, 0.0, 2.0);
  add_wall(grid, {0.0, 0.62}, 0.0, 2.0);
  EXPECT_EQ(wall_thickness(grid).doubled, 0.0);
}

TEST(WallThickness, LeavesOutWhatIsNoWall) {
  VoxelGrid grid = empty();
  EXPECT_EQ(wall_thickness(grid).cells, 0);
  EXPECT_TRUE(std::isnan(wall_thickness(grid).median));
  EXPECT_TRUE(std::isnan(wall_thickness(grid).doubled));
  // A pillar, and a bench 0.4 m high.
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      for (int k = 0; k < 40; ++k) grid.set(i, j, k, CellState::kOccupied);
    }
  }
  for (int i = 20; i < 50; ++i) {
    for (int k = 0; k < 8; ++k) grid.set(i, 20, k, CellState::kOccupied);
  }
  EXPECT_EQ(wall_thickness(grid).cells, 0);
}

}  // namespace
}  // namespace prospect::wall_thickness_test
