// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/known_free.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/adapters/box_room.h"

namespace prospect::known_free_test {
namespace {

constexpr VerticalExtent kSlice{0.1, 0.5};

bool holds(const std::vector<Disc>& discs, const Eigen::Vector2d& p) {
  for (const Disc& d : discs) {
    if ((p - d.center).norm() <= d.radius) return true;
  }
  return false;
}

TEST(KnownFree, WithRoomItIsOneDisc) {
  const World world = test::box_room(4.0, 4.0);
  const auto discs = known_free(world, world.start, 0.18, kSlice, 0.1);
  ASSERT_EQ(discs.size(), 1u);
  EXPECT_EQ(discs[0].center, (Eigen::Vector2d(2.0, 2.0)));
  EXPECT_NEAR(discs[0].radius, 0.255, 1e-12);
}

TEST(KnownFree, BesideAWallItIsWhatIsFreeOnThisSide) {
  World world = test::box_room(4.0, 4.0, 2.0, 0.05);
  // A thin wall, half of a column of the map wide, and free space behind it.
  test::fill(world, {1.75, 0.0, 0.0}, {1.8, 4.0, 2.0});
  world.start.position = {2.0, 2.0, 0.0};
  const auto discs = known_free(world, world.start, 0.18, kSlice, 0.1);
  EXPECT_GT(discs.size(), 8u);
  for (int i = 10; i < 30; ++i) {
    for (int j = 10; j < 30; ++j) {
      const Eigen::Vector2d center(0.1 * i + 0.05, 0.1 * j + 0.05);
      const bool expected =
          (center - world.start.position.head<2>()).norm() <= 0.255 && 0.1 * i > 1.79;
      EXPECT_EQ(holds(discs, center), expected) << center.transpose();
    }
  }
}

TEST(KnownFree, WhereNothingIsFreeAllOverNothingIsKnown) {
  World world = test::box_room(4.0, 4.0, 2.0, 0.05);
  test::fill(world, {2.05, 0.0, 0.2}, {2.1, 4.0, 0.3});
  world.start.position = {2.02, 2.0, 0.0};
  EXPECT_TRUE(known_free(world, world.start, 0.18, kSlice, 0.1).empty());
}

TEST(KnownFree, IsEnteredWhereTheMapHasIt) {
  OccupancyMapper map;
  // A quarter turn, then a way: what was at (1, 0) is at (3, 6).
  clear_free(map, {{{1.0, 0.0}, 0.26}}, 0.0, 1.0, {{3.0, 5.0}, M_PI / 2.0});
  const auto ground = map.ground();
  const auto state = [&](double x, double y) { return ground->state(ground->frame().cell(x, y)); };
  EXPECT_EQ(state(3.02, 6.02), CellState::kFree);
  EXPECT_EQ(state(3.17, 6.17), CellState::kFree);
  EXPECT_EQ(state(3.33, 6.02), CellState::kUnknown);
  EXPECT_EQ(state(1.02, 0.02), CellState::kUnknown);
}

}  // namespace
}  // namespace prospect::known_free_test
