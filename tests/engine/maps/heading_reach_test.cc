// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/heading_reach.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "tests/not_under_sanitizers.h"

namespace prospect::heading_reach_test {
namespace {

using Mask = HeadingMask;

constexpr Mask bit(int k) { return Mask{1} << ((k + 2 * kHeadings) % kHeadings); }
/// East, north, west, south, each with a step to either side.
Mask about(int quarter) {
  return bit(16 * quarter) | bit(16 * quarter - 1) | bit(16 * quarter + 1);
}

bool nothing_solid(Cell) { return false; }

TEST(HeadingReach, TurnsThroughRunsOnly) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 2000; ++n) {
    const Mask within = random() | (n % 2 ? random() : 0);
    const Mask some = random() & random() & random() & random();
    Mask expected = some & within;
    for (int step = 0; step < kHeadings; ++step) {
      for (int k = 0; k < kHeadings; ++k) {
        if ((expected & (bit(k - 1) | bit(k + 1))) != 0) expected |= within & bit(k);
      }
    }
    ASSERT_EQ(turned_through(some, within), expected);
  }
  EXPECT_EQ(turned_through(bit(5), kAllHeadings), kAllHeadings);
  EXPECT_EQ(turned_through(0, kAllHeadings), kNoHeading);
}

/// The states reached, one by one: as the header says.
std::vector<std::array<bool, kHeadings>> slowly(const Grid<Mask>& fits, Cell start, int heading,
                                                bool free_moves, bool backwards) {
  std::vector<std::array<bool, kHeadings>> reached(fits.data.size());
  std::vector<std::pair<Cell, int>> open{{start, heading}};
  const auto enter = [&](Cell c, int k) {
    k = (k + kHeadings) % kHeadings;
    if ((fits.get(c, 0) & bit(k)) == 0) return;
    bool& in = reached[static_cast<std::size_t>(fits.frame.index(c))][static_cast<std::size_t>(k)];
    if (!in) open.emplace_back(c, k);
    in = true;
  };
  enter(start, heading);
  open.erase(open.begin());
  while (!open.empty()) {
    const auto [c, k] = open.back();
    open.pop_back();
    enter(c, k - 1);
    enter(c, k + 1);
    for (const Cell d : {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}}) {
      const double ahead = (backwards ? -1.0 : 1.0) *
                           (d.i * std::cos(heading_at(k)) + d.j * std::sin(heading_at(k)));
      if (free_moves || ahead > 1e-9) enter({c.i + d.i, c.j + d.j}, k);
    }
  }
  return reached;
}

TEST(HeadingReach, IsTheSetOfAllStatesThatMovesLeadTo) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::mt19937_64 random(7);
  const GridFrame frame{0.1, -3, 5, 17, 13};
  int partly = 0, dropped = 0;
  for (int n = 0; n < 120; ++n) {
    Grid<Mask> fits(frame, kNoHeading);
    for (Mask& m : fits.data) {
      const auto kind = random() % 8;
      m = kind == 0 ? kAllHeadings : kind < 3 ? random() | random() : kind < 6 ? random() : 0;
    }
    const Cell start{5, 11};
    const int heading = static_cast<int>(random() % kHeadings);
    fits[start] |= bit(heading);
    const bool free_moves = n % 2 == 0;
    HeadingReach reach;
    reach.update(fits, frame.center(start), heading_at(heading), free_moves, nothing_solid);
    ASSERT_TRUE(reach.started());
    const auto there = slowly(fits, start, heading, free_moves, false);
    // Of bases that only drive forward: what leads to a place to turn in, by moves backwards from
    // each.
    std::vector<std::array<bool, kHeadings>> back(there.size());
    for (std::size_t c = 0; c < there.size() && !free_moves; ++c) {
      if (fits.data[c] != kAllHeadings || !there[c][0]) continue;
      const auto from = slowly(fits, frame.at(static_cast<int>(c)), 0, false, true);
      for (std::size_t q = 0; q < from.size(); ++q) {
        for (std::size_t k = 0; k < kHeadings; ++k) back[q][k] = back[q][k] || from[q][k];
      }
    }
    const auto at = static_cast<std::size_t>(frame.index(start));
    const bool gets_out = back[at][static_cast<std::size_t>(heading)];
    int count = 0;
    for (std::size_t c = 0; c < there.size(); ++c) {
      for (std::size_t k = 0; k < kHeadings; ++k) {
        const bool expected = there[c][k] && (free_moves || !gets_out || back[c][k]);
        const bool in = (reach.reached().data[c] & bit(static_cast<int>(k))) != 0;
        ASSERT_EQ(in, expected) << n << ' ' << c << ' ' << k;
        count += in;
        dropped += there[c][k] && !in;
      }
    }
    partly += count > 1000 && count < 10000;
  }
  EXPECT_GT(partly, 20);
  EXPECT_GT(dropped, 100);
}

/// Two rooms of 5 x 5 cells in which the body can turn, 10 cells apart, and what lies between.
Grid<Mask> rooms(Mask between, bool second_room) {
  Grid<Mask> fits(GridFrame{0.1, 0, 0, 20, 5}, kNoHeading);
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 5; ++j) {
      if (i < 5 || (second_room && i >= 15)) {
        fits[{i, j}] = kAllHeadings;
      } else if (j == 2) {
        fits[{i, j}] = between;
      }
    }
  }
  return fits;
}

TEST(HeadingReach, ACorridorIsPassedLengthwaysOnly) {
  HeadingReach reach;
  for (const bool free_moves : {false, true}) {
    reach.update(rooms(about(0) | about(2), true), {0.25, 0.25}, 1.0, free_moves, nothing_solid);
    EXPECT_EQ(reach.reached()[(Cell{17, 0})], kAllHeadings);
    EXPECT_EQ(reach.reached()[(Cell{9, 2})], about(0) | about(2));
  }
  // A base that only drives forward does not pass it across its heading.
  const Mask north = bit(16);
  reach.update(rooms(north, true), {0.25, 0.25}, 1.0, false, nothing_solid);
  EXPECT_EQ(reach.reached()[(Cell{17, 0})], kNoHeading);
  reach.update(rooms(north, true), {0.25, 0.25}, 1.0, true, nothing_solid);
  EXPECT_EQ(reach.reached()[(Cell{17, 0})], kAllHeadings);
}

TEST(HeadingReach, ADeadEndCountsForThoseThatCanBackOut) {
  HeadingReach reach;
  const Grid<Mask> fits = rooms(about(0) | about(2), false);
  reach.update(fits, {0.25, 0.25}, 0.0, true, nothing_solid);
  EXPECT_NE(reach.reached()[(Cell{14, 2})], kNoHeading);
  reach.update(fits, {0.25, 0.25}, 0.0, false, nothing_solid);
  EXPECT_EQ(reach.reached()[(Cell{14, 2})], kNoHeading);
  EXPECT_EQ(reach.reached()[(Cell{3, 3})], kAllHeadings);
  // Who starts in it, facing out, gets out; facing in, drives on to its end.
  reach.update(fits, {1.05, 0.25}, M_PI, false, nothing_solid);
  EXPECT_EQ(reach.reached()[(Cell{3, 3})], kAllHeadings);
  EXPECT_EQ(reach.reached()[(Cell{14, 2})], kNoHeading);
  reach.update(fits, {1.05, 0.25}, 0.0, false, nothing_solid);
  EXPECT_EQ(reach.reached()[(Cell{3, 3})], kNoHeading);
  EXPECT_EQ(reach.reached()[(Cell{14, 2})], about(0));
}

TEST(HeadingReach, HeadingsThatNoTurnJoinsAreNotReached) {
  // Narrow passages that cross: the body gets through either, but not from one into the other.
  Grid<Mask> fits(GridFrame{0.1, 0, 0, 21, 21}, kNoHeading);
  for (int i = 1; i < 20; ++i) {
    fits[{i, 10}] = about(0) | about(2);
    fits[{10, i}] = about(1) | about(3);
  }
  fits[{10, 10}] = about(0) | about(1) | about(2) | about(3);
  HeadingReach reach;
  reach.update(fits, {0.55, 1.05}, 0.0, true, nothing_solid);
  EXPECT_EQ(reach.reached()[(Cell{19, 10})], about(0));
  EXPECT_EQ(reach.reached()[(Cell{10, 12})], kNoHeading);
}

TEST(HeadingReach, StartsAtTheNearestStateOnThisSideOfAWall) {
  Grid<Mask> fits(GridFrame{0.1, 0, 0, 30, 10}, kNoHeading);
  for (int i = 0; i < 30; ++i) {
    for (int j = 0; j < 10; ++j) {
      if (i < 8 || i > 12) fits[{i, j}] = kAllHeadings;
    }
  }
  const auto wall = [](Cell c) { return c.i == 11; };
  HeadingReach reach;
  // From the cell before the wall the far room is nearer.
  reach.update(fits, {1.06, 0.5}, 0.0, true, wall);
  ASSERT_TRUE(reach.started());
  EXPECT_NE(reach.reached()[(Cell{2, 5})], kNoHeading);
  EXPECT_EQ(reach.reached()[(Cell{20, 5})], kNoHeading);
  reach.update(fits, {1.06, 0.5}, 0.0, true, nothing_solid);
  EXPECT_NE(reach.reached()[(Cell{20, 5})], kNoHeading);
  reach.update(fits, {9.0, 0.5}, 0.0, true, nothing_solid);
  EXPECT_FALSE(reach.started());
}

}  // namespace
}  // namespace prospect::heading_reach_test
