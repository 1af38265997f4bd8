#include "benchmarks/experiments/mission_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "adapters/worlds/load_world.h"

namespace prospect::mission_start_test {
namespace {

TEST(MissionStart, SeedOneKeepsTheWorldsOwnAndOthersDrawWhereTheRobotStands) {
  const World world = load_world("office");
  const ReachableArea area = reachable_area(world);
  const Pose own = mission_start(world.start, area, 1);
  EXPECT_EQ(own.position, world.start.position);
  EXPECT_EQ(own.yaw, world.start.yaw);
  std::set<std::pair<double, double>> places;
  for (std::uint64_t seed = 2; seed <= 11; ++seed) {
    const Pose start = mission_start(world.start, area, seed);
    EXPECT_EQ(area.standing[area.standing.frame.cell(start.position.x(), start.position.y())], 1);
    EXPECT_LE(std::abs(start.yaw), M_PI);
    World moved = world;
    moved.start = start;
    EXPECT_EQ(reachable_area(moved).area, area.area);  // the robot can stand there
    EXPECT_EQ(mission_start(world.start, area, seed).position, start.position);
    places.emplace(start.position.x(), start.position.y());
  }
  EXPECT_EQ(places.size(), 10U);
}

}  // namespace
}  // namespace prospect::mission_start_test
