#include "engine/frontiers/way_lengths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/engine/ground_worlds.h"

namespace prospect::way_lengths_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Traversability of(const GroundMap& map) {
  Traversability t{TraversabilityOptions{}};
  t.update(map);
  return t;
}

// Two rooms of 5 m and 4 m, with a wall of one cell between them that has a doorway, or none.
GroundMap rooms(bool door) {
  GroundMap map(GridFrame{0.1, 0, 0, 120, 70});
  for (int j = 10; j < 60; ++j) {
    for (int i = 10; i < 100; ++i) {
      const bool wall =
          i == 10 || j == 10 || i == 99 || j == 59 || (i == 60 && !(door && j >= 45 && j < 55));
      map.set({i, j}, wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

TEST(WayLengths, GoThroughDoorsAndNotThroughWalls) {
  for (const bool door : {false, true}) {
    WayLengths ways;
    ways.update(of(rooms(door)));
    ways.flood({30, 20});
    const double beyond = ways.length({80, 20});
    if (!door) {
      EXPECT_EQ(beyond, kInfinity);
      continue;
    }
    // By the middle of the door: 4.2 m each way, tight for some of it.
    EXPECT_GT(beyond, 7.0);
    EXPECT_LT(beyond, 13.0);
    EXPECT_NEAR(ways.departure({80, 20}), std::atan2(3.0, 3.0), 0.35);
  }
}

TEST(WayLengths, AreThoseOfTheCrowInTheOpenWithinEightPercentAndTwoBlocks) {
  GroundMap map(GridFrame{0.1, 0, 0, 200, 200});
  for (int k = 0; k < map.frame().size(); ++k) map.set(map.frame().at(k), CellState::kFree);
  WayLengths ways;
  ways.update(of(map));
  ways.flood({100, 100});
  std::mt19937_64 random(2);
  for (int n = 0; n < 200; ++n) {
    const Cell c{20 + static_cast<int>(random() % 160), 20 + static_cast<int>(random() % 160)};
    const double d = 0.1 * std::hypot(c.i - 100, c.j - 100);
    EXPECT_GE(ways.length(c), d - 0.6);
    EXPECT_LE(ways.length(c), 1.083 * d + 0.6);
  }
}

TEST(WayLengths, AgreeWithCellsAboutWhatIsReached) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 6; ++trial) {
    const auto world = test::GroundWorld::rooms(16.0, 0.1, 80, random);
    GroundMap map(world.truth.frame);
    for (int k = 0; k < map.frame().size(); ++k) {
      map.set(map.frame().at(k), world.truth.data[static_cast<std::size_t>(k)]);
    }
    const Traversability t = of(map);
    const Cell start = world.open_cell(4, random);
    WayLengths ways;
    ways.update(t);
    ways.flood(start);
    Grid<std::uint8_t> reached(t.frame(), 0);
    std::vector<Cell> stack{start};
    reached[start] = 1;
    while (!stack.empty()) {
      const Cell c = stack.back();
      stack.pop_back();
      for (const Cell n :
           {Cell{c.i - 1, c.j}, Cell{c.i + 1, c.j}, Cell{c.i, c.j - 1}, Cell{c.i, c.j + 1}}) {
        if (!t.passable(n) || reached[n] != 0) continue;
        reached[n] = 1;
        stack.push_back(n);
      }
    }
    int differ = 0, passable = 0;
    for (int k = 0; k < t.frame().size(); ++k) {
      const Cell c = t.frame().at(k);
      if (!t.passable(c)) continue;
      ++passable;
      EXPECT_FALSE(reached[c] != 0 && ways.length(c) == kInfinity) << "a way was lost";
      differ += (reached[c] != 0) != (ways.length(c) < kInfinity);
    }
    EXPECT_LT(differ, passable / 50);
  }
}

TEST(WayLengths, APriceOfADirectionMakesWaysDearerThatWay) {
  WayLengths ways;
  const Traversability t = of(rooms(true));
  ways.update(t);
  ways.flood({30, 30});
  const double east = ways.length({50, 30}), west = ways.length({15, 30});
  ways.begin_at_robot(t, {30, 30});
  ways.extend(kInfinity, [](Cell, double yaw) { return std::cos(yaw) > 0.5 ? 1.0 : 0.0; });
  EXPECT_NEAR(ways.length({50, 30}), 2.0 * east, 0.35);
  EXPECT_EQ(ways.length({15, 30}), west);
  EXPECT_NEAR(ways.unpriced({50, 30}), east, 0.35);
  EXPECT_EQ(ways.unpriced({15, 30}), west);
}

TEST(WayLengths, ALimitEndsTheFloodAndARobotInAWallBeginsBesideIt) {
  WayLengths ways;
  EXPECT_EQ(ways.length({0, 0}), kInfinity);
  const Traversability t = of(rooms(true));
  ways.update(t);
  ways.flood({30, 20}, 2.0);
  EXPECT_LT(ways.length({45, 20}), kInfinity);
  EXPECT_EQ(ways.length({55, 50}), kInfinity);
  ways.flood({10, 30});
  EXPECT_EQ(ways.length({45, 20}), kInfinity) << "in the wall";
  ways.begin_at_robot(t, {10, 30});
  ways.extend(kInfinity);
  EXPECT_LT(ways.length({45, 20}), kInfinity);
  // Not through another wall.
  ways.update(of(rooms(false)));
  ways.begin_at_robot(of(rooms(false)), {57, 30});
  ways.extend(kInfinity);
  EXPECT_LT(ways.length({45, 20}), kInfinity);
  EXPECT_EQ(ways.length({80, 20}), kInfinity);
  ways.begin_at_robot(t, {-500, 0});
  ways.extend(kInfinity);
  EXPECT_EQ(ways.length({45, 20}), kInfinity);
}

TEST(WayLengths, AFloodInStagesIsTheFloodAtOnceAndOneThatHasEnoughStops) {
  const Traversability t = of(rooms(true));
  WayLengths once, stages;
  once.update(t);
  stages.update(t);
  once.begin_at_robot(t, {30, 30});
  once.extend(kInfinity);
  stages.begin_at_robot(t, {30, 30});
  for (const double limit : {0.5, 1.0, 3.0, 5.0, kInfinity}) {
    stages.extend(limit);
    for (int k = 0; k < t.frame().size(); ++k) {
      const Cell c = t.frame().at(k);
      if (once.length(c) <= limit) {
        ASSERT_EQ(stages.length(c), once.length(c)) << limit;
      }
    }
  }
  once.flood({30, 30}, kInfinity, [](Cell, double length) { return length > 2.0; });
  EXPECT_LT(once.length({45, 30}), kInfinity);
  EXPECT_EQ(once.length({80, 30}), kInfinity);
}

TEST(WayLengths, AnUpdateIsAComputationFromScratch) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 4; ++trial) {
    const auto world = test::GroundWorld::rooms(12.0, 0.1, 60, random);
    GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
    Traversability t{TraversabilityOptions{}};
    WayLengths kept;
    for (int step = 0; step < 12; ++step) {
      const Eigen::Vector2d p = world.truth.frame.center(world.open_cell(4, random));
      world.sense({{p.x(), p.y(), 0.0}, 0.1 * static_cast<double>(random() % 63)}, 4.0, 1.05, map);
      // Walls come and go.
      for (int n = 0; n < 20; ++n) {
        const Cell c = map.frame().at(static_cast<int>(random() % map.cells().data.size()));
        if (map.explored(c)) {
          map.set(c, random() % 2 == 0 ? CellState::kOccupied : CellState::kFree);
        }
      }
      t.update(map);
      kept.update(t);
      WayLengths fresh;
      fresh.update(t);
      const Cell from = t.frame().cell(p.x(), p.y());
      kept.flood(from);
      fresh.flood(from);
      for (int k = 0; k < t.frame().size(); ++k) {
        const Cell c = t.frame().at(k);
        ASSERT_EQ(kept.length(c), fresh.length(c)) << trial << " " << step;
      }
    }
  }
}

}  // namespace
}  // namespace prospect::way_lengths_test
