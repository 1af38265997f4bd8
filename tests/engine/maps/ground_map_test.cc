// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/ground_map.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>

namespace prospect::ground_map_test {
namespace {

std::uint64_t revision_at(const GroundMap& map, Cell c) {
  const GridFrame& f = map.frame();
  return map.tile_revision((c.i - f.i0) / GroundMap::kTile, (c.j - f.j0) / GroundMap::kTile);
}

TEST(GroundMap, IsWidenedToWholeTilesAlsoOnTheNegativeSide) {
  const GroundMap map(GridFrame{0.1, -17, 15, 2, 2});
  EXPECT_EQ(map.frame(), (GridFrame{0.1, -32, 0, 32, 32}));
  EXPECT_EQ(map.tiles_x(), 2);
  EXPECT_EQ(map.tiles_y(), 2);
  EXPECT_EQ(map.tile_frame(1, 0), (GridFrame{0.1, -16, 0, 16, 16}));
  EXPECT_EQ(GroundMap(GridFrame{0.1, -16, -16, 16, 16}).frame(),
            (GridFrame{0.1, -16, -16, 16, 16}));
  EXPECT_EQ(GroundMap(GridFrame{0.1, 5, -5, 0, 0}).frame(), (GridFrame{0.1, 0, -16, 16, 16}));
  EXPECT_EQ(map.revision(), 0u);
}

TEST(GroundMap, ARevisionIsBumpedOnlyByARealChange) {
  GroundMap map(GridFrame{0.1, 0, 0, 32, 32});
  map.set({3, 4}, CellState::kFree);
  EXPECT_EQ(map.revision(), 1u);
  EXPECT_EQ(map.tile_revision(0, 0), 1u);
  map.set({3, 4}, CellState::kFree);
  map.set({20, 4}, CellState::kUnknown);
  EXPECT_EQ(map.revision(), 1u);
  map.set({20, 4}, CellState::kOccupied);
  EXPECT_EQ(map.tile_revision(1, 0), 2u);
  EXPECT_EQ(map.tile_revision(0, 0), 1u);
  EXPECT_EQ(map.tile_revision(0, 1), 0u);
  EXPECT_EQ(map.free_cells(), 1);
  EXPECT_EQ(map.occupied_cells(), 1);
  EXPECT_TRUE(map.explored({20, 4}));
  EXPECT_FALSE(map.explored({-1000, 4}));
  map.set({20, 4}, CellState::kUnknown);
  EXPECT_EQ(map.occupied_cells(), 0);
  EXPECT_EQ(map.revision(), 3u);
}

TEST(GroundMap, ForgettingBeyondTheMapDoesNotGrowIt) {
  GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
  map.set({-500, 900}, CellState::kUnknown);
  EXPECT_EQ(map.frame(), (GridFrame{0.1, 0, 0, 16, 16}));
  EXPECT_EQ(map.revision(), 0u);
}

TEST(GroundMap, GrowsOnlyTowardsTheCell) {
  // Far on the negative side: growth in y must not reach back to the lattice's origin in x.
  GroundMap map(GridFrame{0.1, -4000, -4000, 16, 16});
  map.set({-3990, -3980}, CellState::kFree);
  EXPECT_EQ(map.frame().i0, -4000);
  EXPECT_EQ(map.frame().width, 16);
  EXPECT_EQ(map.frame().j0, -4000);
  EXPECT_GT(map.frame().height, 20);
  EXPECT_LT(map.frame().height, 300);
  map.set({-3900, -3990}, CellState::kFree);
  EXPECT_LT(map.frame().width, 400);
}

/// Against a map from cell to state, over walks that grow the map to all sides and across zero.
TEST(GroundMap, GrowthKeepsCellsAndRevisions) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](int a, int b) {
      return std::uniform_int_distribution<int>(a, b)(random);
    };
    GroundMap map(
        GridFrame{0.05, uniform(-300, 300), uniform(-300, 300), uniform(0, 40), uniform(0, 40)});
    std::map<std::pair<int, int>, CellState> truth;
    std::map<std::pair<int, int>, std::uint64_t> newest;  // by tile of the lattice
    const auto tile = [](Cell c) {
      const auto down = [](int a) { return (a - ((a % 16) + 16) % 16) / 16; };
      return std::pair(down(c.i), down(c.j));
    };
    std::uint64_t revision = 0;
    for (int n = 0; n < 3000; ++n) {
      const int span = 20 + n / 4;
      const Cell c{uniform(-span, span), uniform(-span, span)};
      const auto state = static_cast<CellState>(uniform(0, 2));
      CellState& known = truth.try_emplace({c.i, c.j}, CellState::kUnknown).first->second;
      if (known != state) newest[tile(c)] = ++revision;
      known = state;
      map.set(c, state);
      ASSERT_EQ(map.revision(), revision);
    }
    int free = 0, occupied = 0;
    for (const auto& [address, state] : truth) {
      const Cell c{address.first, address.second};
      ASSERT_EQ(map.state(c), state);
      free += state == CellState::kFree;
      occupied += state == CellState::kOccupied;
      if (map.frame().contains(c)) {
        const auto it = newest.find(tile(c));
        ASSERT_EQ(revision_at(map, c), it == newest.end() ? 0u : it->second);
      }
    }
    EXPECT_EQ(map.free_cells(), free);
    EXPECT_EQ(map.occupied_cells(), occupied);
    EXPECT_EQ(map.frame().width % GroundMap::kTile, 0);
    EXPECT_EQ(map.frame().height % GroundMap::kTile, 0);
    EXPECT_EQ(((map.frame().i0 % 16) + 16) % 16, 0);
    EXPECT_EQ(((map.frame().j0 % 16) + 16) % 16, 0);
    // What was never set is unknown, so the counts cover the whole map.
    int known_cells = 0;
    for (int i = 0; i < map.frame().size(); ++i) known_cells += map.explored(map.frame().at(i));
    EXPECT_EQ(known_cells, free + occupied);
  }
}

}  // namespace
}  // namespace prospect::ground_map_test
