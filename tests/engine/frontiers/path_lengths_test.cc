// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/path_lengths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/engine/ground_worlds.h"

namespace prospect::path_lengths_test {
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

TEST(PathLengths, GoThroughDoorsAndNotThroughWalls) {
  for (const bool door : {false, true}) {
    PathLengths paths;
    paths.update(of(rooms(door)));
    paths.flood({30, 20});
    const double beyond = paths.length({80, 20});
    if (!door) {
      EXPECT_EQ(beyond, kInfinity);
      continue;
    }
    // By the middle of the door: 4.2 m each path, tight for some of it.
    EXPECT_GT(beyond, 7.0);
    EXPECT_LT(beyond, 13.0);
    EXPECT_NEAR(paths.departure({80, 20}), std::atan2(3.0, 3.0), 0.35);
  }
}

TEST(PathLengths, AreThoseOfTheCrowInTheOpenWithinEightPercentAndTwoBlocks) {
  GroundMap map(GridFrame{0.1, 0, 0, 200, 200});
  for (int k = 0; k < map.frame().size(); ++k) map.set(map.frame().at(k), CellState::kFree);
  PathLengths paths;
  paths.update(of(map));
  paths.flood({100, 100});
  std::mt19937_64 random(2);
  for (int n = 0; n < 200; ++n) {
    const Cell c{20 + static_cast<int>(random() % 160), 20 + static_cast<int>(random() % 160)};
    const double d = 0.1 * std::hypot(c.i - 100, c.j - 100);
    EXPECT_GE(paths.length(c), d - 0.6);
    EXPECT_LE(paths.length(c), 1.083 * d + 0.6);
  }
}

TEST(PathLengths, AgreeWithCellsAboutWhatIsReached) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 6; ++trial) {
    const auto world = test::GroundWorld::rooms(16.0, 0.1, 80, random);
    GroundMap map(world.truth.frame);
    for (int k = 0; k < map.frame().size(); ++k) {
      map.set(map.frame().at(k), world.truth.data[static_cast<std::size_t>(k)]);
    }
    const Traversability t = of(map);
    const Cell start = world.open_cell(4, random);
    PathLengths paths;
    paths.update(t);
    paths.flood(start);
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
      EXPECT_FALSE(reached[c] != 0 && paths.length(c) == kInfinity) << "a way was lost";
      differ += (reached[c] != 0) != (paths.length(c) < kInfinity);
    }
    EXPECT_LT(differ, passable / 50);
  }
}

TEST(PathLengths, APriceOfADirectionMakesPathsDearerThatWay) {
  PathLengths paths;
  const Traversability t = of(rooms(true));
  paths.update(t);
  paths.flood({30, 30});
  const double east = paths.length({50, 30}), west = paths.length({15, 30});
  paths.begin_at_robot(t, {30, 30});
  paths.extend(kInfinity, [](Cell, double yaw) { return std::cos(yaw) > 0.5 ? 1.0 : 0.0; });
  EXPECT_NEAR(paths.length({50, 30}), 2.0 * east, 0.35);
  EXPECT_EQ(paths.length({15, 30}), west);
  EXPECT_NEAR(paths.unpriced({50, 30}), east, 0.35);
  EXPECT_EQ(paths.unpriced({15, 30}), west);
}

TEST(PathLengths, ALimitEndsTheFloodAndARobotInAWallBeginsBesideIt) {
  PathLengths paths;
  EXPECT_EQ(paths.length({0, 0}), kInfinity);
  const Traversability t = of(rooms(true));
  paths.update(t);
  paths.flood({30, 20}, 2.0);
  EXPECT_LT(paths.length({45, 20}), kInfinity);
  EXPECT_EQ(paths.length({55, 50}), kInfinity);
  paths.flood({10, 30});
  EXPECT_EQ(paths.length({45, 20}), kInfinity) << "in the wall";
  paths.begin_at_robot(t, {10, 30});
  paths.extend(kInfinity);
  EXPECT_LT(paths.length({45, 20}), kInfinity);
  // Not through another wall.
  paths.update(of(rooms(false)));
  paths.begin_at_robot(of(rooms(false)), {57, 30});
  paths.extend(kInfinity);
  EXPECT_LT(paths.length({45, 20}), kInfinity);
  EXPECT_EQ(paths.length({80, 20}), kInfinity);
  paths.begin_at_robot(t, {-500, 0});
  paths.extend(kInfinity);
  EXPECT_EQ(paths.length({45, 20}), kInfinity);
}

TEST(PathLengths, AFloodInStagesIsTheFloodAtOnceAndOneThatHasEnoughStops) {
  const Traversability t = of(rooms(true));
  PathLengths once, stages;
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

TEST(PathLengths, AFloodBesideLeavesTheLengthsAndWorksAsOftenAsIsAsked) {
  const Traversability t = of(rooms(true));
  PathLengths kept, expected;
  kept.update(t);
  expected.update(t);
  kept.flood({30, 30});
  const double before = kept.length({80, 30});
  PathLengths::Search beside;
  for (const Cell from : {Cell{30, 20}, Cell{90, 50}, Cell{30, 20}, Cell{10, 30}}) {
    for (const double limit : {kInfinity, 2.0}) {
      std::vector<double> lengths, anew;
      kept.flood(beside, from, limit, [&](Cell, double length) {
        lengths.push_back(length);
        return false;
      });
      expected.flood(from, limit, [&](Cell, double length) {
        anew.push_back(length);
        return false;
      });
      EXPECT_EQ(lengths, anew);
      EXPECT_EQ(kept.length({80, 30}), before);
    }
  }
}

TEST(PathLengths, AnUpdateIsAComputationFromScratch) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 4; ++trial) {
    const auto world = test::GroundWorld::rooms(12.0, 0.1, 60, random);
    GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
    Traversability t{TraversabilityOptions{}};
    PathLengths kept;
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
      PathLengths fresh;
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
}  // namespace prospect::path_lengths_test
