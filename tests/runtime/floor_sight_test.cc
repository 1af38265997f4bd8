// SPDX-License-Identifier: Apache-2.0
#include "runtime/floor_sight.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prospect::floor_sight_test {
namespace {

DepthSensor camera(double height, double pitch, double x = 0.0) {
  DepthSensor sensor;
  sensor.mount.T_BC = CameraMount::forward_facing({x, 0.0, height}, 0.0, pitch);
  return sensor;
}

TEST(FloorSight, IsWhereRaysStraightAheadMeetTheFloor) {
  const DepthSensor level = camera(0.45, 0.0);
  const double half = 0.5 * level.footprint.vertical_fov, range = level.footprint.max_range;
  const auto sight = floor_sight({level}, 0.0, 0.0);
  ASSERT_TRUE(sight);
  EXPECT_NEAR(sight->from, 0.45 / std::tan(half), 0.01);
  EXPECT_NEAR(sight->to, std::sqrt(range * range - 0.45 * 0.45), 0.05);
  // One that looks down sees it nearer, one farther ahead on the robot farther off.
  const auto down = floor_sight({camera(0.45, 0.5, 0.2)}, 0.0, 0.0);
  ASSERT_TRUE(down);
  EXPECT_NEAR(down->from, 0.2 + 0.45 / std::tan(half + 0.5), 0.01);
  EXPECT_NEAR(down->to, 0.2 + std::sqrt(range * range - 0.45 * 0.45), 0.05);
  EXPECT_NEAR(floor_sight({camera(0.45, 0.8)}, 0.0, 0.0)->to, 0.45 / std::tan(0.8 - half), 0.02);
  EXPECT_LT(down->from, sight->from);
  // The floor is below B's origin.
  EXPECT_GT(floor_sight({level}, 0.3, 0.0)->from, sight->from);
}

TEST(FloorSight, EndsWhereRaysDoNotGetDownFarEnoughToShowThatTheFloorIsMissing) {
  // Of two sides of similar triangles: a quarter of the range goes down into the hole.
  for (const double drop : {0.0, 0.05, 0.1}) {
    const DepthSensor low = camera(0.15, 0.2);
    const double range = low.footprint.max_range * 0.15 / (0.15 + drop);
    const auto sight = floor_sight({low}, 0.0, drop);
    ASSERT_TRUE(sight);
    EXPECT_NEAR(sight->to, std::sqrt(range * range - 0.15 * 0.15), 0.1);
    // What is near is seen as floor all the same.
    EXPECT_EQ(sight->from, floor_sight({low}, 0.0, 0.0)->from);
  }
}

TEST(FloorSight, ThereIsNoneWhereNoSensorLooksDownAhead) {
  DepthSensor lidar = camera(0.3, 0.0);
  lidar.footprint.vertical_fov = 0.0;
  DepthSensor behind = camera(0.45, 0.3);
  behind.mount.T_BC = CameraMount::forward_facing({0.0, 0.0, 0.45}, M_PI, 0.3);
  EXPECT_FALSE(floor_sight({}, 0.0, 0.0));
  EXPECT_FALSE(floor_sight({lidar, behind}, 0.0, 0.0));
  EXPECT_TRUE(floor_sight({lidar, behind, camera(0.45, 0.0)}, 0.0, 0.0));
}

TEST(FloorSight, BoundsTheSpeedByTheWayToStop) {
  for (const double delay : {0.0, 0.6}) {
    for (const double sight : {0.1, 1.0, 3.0}) {
      const double v = speed_for_sight(sight, delay, 0.8);
      EXPECT_NEAR(v * delay + v * v / 1.6, sight, 1e-12);
    }
  }
  EXPECT_EQ(speed_for_sight(0.0, 0.5, 0.8), 0.0);
  EXPECT_EQ(speed_for_sight(-1.0, 0.5, 0.8), 0.0);
}

}  // namespace
}  // namespace prospect::floor_sight_test
