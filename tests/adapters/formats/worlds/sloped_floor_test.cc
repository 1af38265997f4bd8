// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/sloped_floor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/world_file.h"
#include "adapters/formats/worlds/world_hash.h"

namespace prospect::sloped_floor_test {
namespace {

/// A hall with a ramp up to a platform, and a threshold.
World hall(const std::string& ramps =
               "  - {box: [2, 1, 5.6, 3], z: [0, 0.5], up: east}\n"
               "  - {box: [5.6, 1, 7, 3], z: [0.5, 0.5]}\n"
               "  - {box: [8, 0, 8.2, 4], z: [0.04, 0.04]}\n") {
  return world_from_yaml(
      "textures: {brick: 40}\n"
      "rooms: [{box: [0, 0, 10, 4], walls: brick, floor: brick}]\n"
      "ramps:\n" +
          ramps + "start: [1, 2, 0]\n",
      "hall");
}

TEST(SlopedFloor, HeightAndTiltFollowTheRamp) {
  const World world = hall();
  EXPECT_EQ(floor_height(world, {1.0, 2.0}), 0.0);
  EXPECT_NEAR(floor_height(world, {3.8, 2.0}), 0.25, 1e-12);
  EXPECT_EQ(floor_height(world, {6.0, 2.0}), 0.5);
  for (const double yaw : {0.0, 0.7, M_PI}) {
    const Standing on_ramp = standing(world, {3.8, 2.0}, yaw);
    EXPECT_NEAR(on_ramp.height, 0.25, 1e-9);
    const Eigen::Vector3d up = on_ramp.tilt * Eigen::Vector3d::UnitZ();
    const double slope = 0.5 / 3.6;  // against the ramp, in B
    const Eigen::Vector3d expected =
        Eigen::Vector3d(-slope * std::cos(yaw), slope * std::sin(yaw), 1.0).normalized();
    EXPECT_NEAR((up - expected).norm(), 0.0, 1e-9);
  }
  EXPECT_TRUE(standing(world, {1.0, 2.0}, 0.3).tilt.isIdentity());
}

TEST(SlopedFloor, RaysMeetTopAndSides) {
  const World world = hall();
  const auto distance = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
    return distance_to_slopes(world.slopes, from, direction.normalized());
  };
  EXPECT_NEAR(distance({3.8, 2.0, 1.0}, {0.0, 0.0, -1.0}), 0.75, 1e-9);
  EXPECT_NEAR(distance({1.0, 2.0, 0.25}, {1.0, 0.0, 0.0}), 2.8, 1e-9);  // where the top is 0.25 m
  EXPECT_NEAR(distance({6.0, 0.2, 0.3}, {0.0, 1.0, 0.0}), 0.8, 1e-9);   // the platform's side
  EXPECT_TRUE(std::isinf(distance({6.0, 0.2, 0.6}, {0.0, 1.0, 0.0})));
  EXPECT_TRUE(std::isinf(distance({1.0, 2.0, 0.3}, {-1.0, 0.0, 0.0})));
}

TEST(SlopedFloor, OverTheFloorARampIsFreeAndItsSidesAreNot) {
  const World world = hall();
  EXPECT_TRUE(world.solid(65, 20, 4));
  EXPECT_FALSE(world.solid(65, 20, 5));
  const auto over = over_the_floor(world, 0.05);
  const auto closed = [&](double x, double y) {
    const Cell c = over->frame().cell(x, y);
    return over->state(c.i, c.j, -1) != CellState::kOccupied;
  };
  for (double x = 2.05; x < 6.9; x += 0.1) EXPECT_FALSE(closed(x, 2.05)) << x;
  EXPECT_TRUE(closed(6.95, 2.05));
  EXPECT_TRUE(closed(5.05, 1.05));
  EXPECT_FALSE(closed(5.05, 0.95));
  EXPECT_FALSE(closed(8.05, 2.05));  // the threshold
  const auto low = over_the_floor(world, 0.02);
  const Cell c = low->frame().cell(8.05, 2.05);
  EXPECT_EQ(low->state(c.i, c.j, -1), CellState::kFree);
  // What is steeper is closed from its foot on.
  const World steep = hall("  - {box: [2, 1, 4.3, 3], z: [0, 0.5], up: east}\n");
  const auto over_steep = over_the_floor(steep, 0.05);
  EXPECT_EQ(over_steep->state(20, 20, -1), CellState::kFree);
  EXPECT_GT(reachable_area(world).area, reachable_area(steep).area);
}

TEST(SlopedFloor, AFlatWorldIsItsOwnAndAWrongRampIsRefused) {
  World flat = hall();
  flat.slopes.clear();
  EXPECT_EQ(over_the_floor(flat, 0.05).get(), &flat.voxels);
  EXPECT_NE(world_hash(flat), world_hash(hall()));
  EXPECT_THROW(hall("  - {box: [2, 1, 4, 3], z: [0.5, 0.1]}\n"), InputError);
  EXPECT_THROW(hall("  - {box: [2, 1, 4, 3], z: [0, 0.1], up: upward}\n"), InputError);
}

}  // namespace
}  // namespace prospect::sloped_floor_test
