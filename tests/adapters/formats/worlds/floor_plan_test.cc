// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/floor_plan.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/world_file.h"

namespace prospect::floor_plan_test {
namespace {

TEST(FloorPlan, IsTheSameForTheSameSeedAndAnotherForAnother) {
  EXPECT_EQ(random_floor_plan(3), random_floor_plan(3));
  EXPECT_NE(random_floor_plan(3), random_floor_plan(4));
  EXPECT_EQ(load_world("plan:3").voxels.data(), load_world("plan:3").voxels.data());
  EXPECT_EQ(load_world("plan:3").name, "plan:3");
}

TEST(FloorPlan, CanBeDrivenThroughFromAnyRoomToAnyOther) {
  const BodySlice slice;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const World world = load_world("plan:" + std::to_string(seed));
    const Grid<std::uint8_t> standing = standing_columns(world.voxels, slice);
    const Grid<std::uint8_t> reached = connected_component(
        standing, standing.frame.cell(world.start.position.x(), world.start.position.y()));
    const auto count = [](const Grid<std::uint8_t>& grid) {
      return std::count(grid.data.begin(), grid.data.end(), 1);
    };
    EXPECT_GT(count(reached), 40 * 100);                // 40 m2 to stand on
    EXPECT_GT(count(reached), 0.98 * count(standing));  // but for corners behind furniture
  }
}

TEST(FloorPlan, HasAsManyRoomsAsAreAskedFor) {
  const World world = load_world("plan:3:5x2");
  EXPECT_EQ(world.name, "plan:3:5x2");
  EXPECT_EQ(world.voxels.data(), load_world("plan:3:5x2").voxels.data());
  const std::string text = random_floor_plan(3, FloorPlanSize{5, 2});
  int rooms = 0;
  for (std::size_t at = 0; (at = text.find("walls:", at)) != std::string::npos; ++at) ++rooms;
  EXPECT_EQ(rooms, 10);
}

TEST(FloorPlan, WithDropsItHasHolesDocksAndStairsAndCanBeDrivenThrough) {
  const BodySlice slice;
  int lowered_plans = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const World world = load_world("drops:" + std::to_string(seed));
    const World flat = load_world("plan:" + std::to_string(seed));
    EXPECT_EQ(world.name, "drops:" + std::to_string(seed));
    ASSERT_EQ(world.voxels.frame(), flat.voxels.frame());
    const Grid<std::uint8_t> standing = standing_columns(world.voxels, slice);
    const Grid<std::uint8_t> reached = connected_component(
        standing, standing.frame.cell(world.start.position.x(), world.start.position.y()));
    const auto count = [](const Grid<std::uint8_t>& grid) {
      return std::count(grid.data.begin(), grid.data.end(), 1);
    };
    EXPECT_GT(count(reached), 0.9 * count(standing));
    lowered_plans +=
        count(free_columns(world.voxels, slice)) + 50 < count(free_columns(flat.voxels, slice));
  }
  EXPECT_EQ(lowered_plans, 40);
}

TEST(FloorPlan, NeedsASeedAndIfAnyAWholeSize) {
  for (const char* name : {"plan:", "plan:x", "plan:-1", "plan:1.5", "plan:1:", "plan:1:3",
                           "plan:1:3x", "plan:1:3x3x", "plan:1:3x3 ", "plan:1:1x3", "plan:1:3x41",
                           "plan:1:-3x4", "plan:1:3x99999999999999999999", "drops:", "drops:1:3"}) {
    EXPECT_THROW(load_world(name), InputError) << name;
  }
}

}  // namespace
}  // namespace prospect::floor_plan_test
