// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/mission_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"

namespace prospect::mission_start_test {
namespace {

TEST(MissionStart, SeedOneKeepsTheWorldsOwnAndOthersDrawWhereTheRobotStands) {
  const World world = load_world("office");
  const Configuration configuration = configuration_from_text("", "defaults");
  const Grid<std::uint8_t> places = roomy_columns(world, configuration);
  const Pose own = mission_start(world.start, places, 1);
  EXPECT_EQ(own.position, world.start.position);
  EXPECT_EQ(own.yaw, world.start.yaw);
  std::set<std::pair<double, double>> drawn;
  for (std::uint64_t seed = 2; seed <= 11; ++seed) {
    const Pose start = mission_start(world.start, places, seed);
    EXPECT_EQ(places[places.frame.cell(start.position.x(), start.position.y())], 1);
    EXPECT_LE(std::abs(start.yaw), M_PI);
    World moved = world;
    moved.start = start;
    EXPECT_EQ(roomy_columns(moved, configuration).data, places.data);  // the robot can stand there
    EXPECT_EQ(mission_start(world.start, places, seed).position, start.position);
    drawn.emplace(start.position.x(), start.position.y());
  }
  EXPECT_EQ(drawn.size(), 10U);
}

}  // namespace
}  // namespace prospect::mission_start_test
