// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/map_messages.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/ros/cdr.h"

namespace prospect::map_messages_test {
namespace {

using Changes = std::vector<std::pair<Cell, CellState>>;

/// What a reader makes of a change.
bool hand_on(const LoggedMap::Messages& change, ReadMap& map) {
  if (change.whole) {
    const std::string bytes = ros::to_cdr(whole_map(change.cells, 0));
    return map.whole(ros::from_cdr<ros::OccupancyGrid>(bytes, "map"));
  }
  const std::string bytes = ros::to_cdr(part_of_map(change, 0));
  return map.part(ros::from_cdr<ros::OccupancyGridUpdate>(bytes, "part"));
}

TEST(MapMessages, AMapThatGrowsIsReadBackChangeByChange) {
  std::mt19937 random(3);
  LoggedMap logged;
  ReadMap read;
  int whole = 0, parts = 0;
  for (int step = 0; step < 60; ++step) {
    Changes changes;
    std::uniform_int_distribution<int> offset(0, 5 + 2 * step), state(0, 2);
    Grid<CellState> seen(GridFrame{0.05, -200, -200, 400, 400}, CellState::kUnknown);
    for (int i = 0; i < 20; ++i) {
      const Cell c{offset(random) - step, offset(random) - 2 * step};
      changes.emplace_back(c, static_cast<CellState>(state(random)));
    }
    const auto change = logged.change(0.5 * step, 0.05, changes);
    ASSERT_TRUE(change.has_value());
    (change->whole ? whole : parts) += 1;
    ASSERT_TRUE(hand_on(*change, read));
    for (const auto& [cell, is] : read.changes()) seen[cell] = is;
    for (const auto& [cell, is] : changes) {
      // The last change of a cell counts; one that changes nothing is none.
      CellState last = is;
      for (const auto& [other, state_of_other] : changes) {
        if (other == cell) last = state_of_other;
      }
      if (seen[cell] != CellState::kUnknown) {
        EXPECT_EQ(seen[cell], last);
      }
    }
  }
  EXPECT_GE(whole, 4) << "at first, every ten seconds, and when it grows";
  EXPECT_GE(parts, 40);
  EXPECT_FALSE(logged.change(100.0, 0.05, {}).has_value());
}

TEST(MapMessages, ChangesAreThoseSinceTheLastTime) {
  LoggedMap logged;
  ReadMap read;
  ASSERT_TRUE(hand_on(*logged.change(0.0, 0.1, {{{2, -3}, CellState::kFree}}), read));
  EXPECT_EQ(read.changes(), (Changes{{{2, -3}, CellState::kFree}}));
  EXPECT_TRUE(read.changes().empty());
  ASSERT_TRUE(hand_on(*logged.change(1.0, 0.1, {{{2, -3}, CellState::kOccupied}}), read));
  EXPECT_EQ(read.changes(), (Changes{{{2, -3}, CellState::kOccupied}}));
}

TEST(MapMessages, WhatFitsNoMapIsPassedOver) {
  ReadMap read;
  const std::vector<std::int8_t> cells(6, 0);
  ros::OccupancyGridUpdate update;
  update.width = 3;
  update.height = 2;
  update.data = cells;
  EXPECT_FALSE(read.part(update)) << "there is no map yet";
  ros::OccupancyGrid grid;
  grid.info.resolution = 0.1F;
  grid.info.width = 3;
  grid.info.height = 3;
  grid.data = cells;
  EXPECT_FALSE(read.whole(grid)) << "six cells are not 3 x 3";
  grid.info.height = 2;
  EXPECT_TRUE(read.whole(grid));
  EXPECT_TRUE(read.part(update));
  update.x = 1;
  EXPECT_FALSE(read.part(update));
  update.x = -1;
  EXPECT_FALSE(read.part(update));
  grid.info.origin.position.x = 0.05;
  EXPECT_FALSE(read.whole(grid)) << "its corner is no cell's";
  grid.info.origin.position.x = 0.0;
  grid.info.origin.orientation = {0.0, 0.0, 1.0, 0.0};
  EXPECT_FALSE(read.whole(grid)) << "turned";
}

}  // namespace
}  // namespace prospect::map_messages_test
