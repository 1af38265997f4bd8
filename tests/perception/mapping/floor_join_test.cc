// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/floor_join.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace prospect::floor_join_test {
namespace {

constexpr double kR = 0.1, kStep = 0.05;
constexpr GridFrame kFrame{kR, -20, -10, 80, 20};

using Heights = std::function<double(double)>;

/// Floor of a height that is a function of x, all over the frame; NaN: none.
FloorJoin::Surfaces surfaces_along_x(const Heights& height) {
  return [height](Cell c, std::vector<FloorSurface>& found) {
    if (!kFrame.contains(c)) return;
    const double z = height(kFrame.center(c).x());
    if (std::isnan(z)) return;
    found.push_back({static_cast<int>(std::ceil(z / kR)) - 1, z, true, z > kStep && z < kR});
  };
}
std::vector<Cell> all_cells() {
  std::vector<Cell> cells;
  for (int n = 0; n < kFrame.size(); ++n) cells.push_back(kFrame.at(n));
  return cells;
}
FloorJoin along_x(const Heights& height) {
  FloorJoin floor(kR, 1, kStep);
  floor.look(all_cells(), surfaces_along_x(height));
  return floor;
}
double ramp(double x, double degrees) {
  return std::max(0.0, x) * std::tan(degrees * M_PI / 180.0);
}
int closed_cells(const FloorJoin& floor) {
  int closed = 0;
  for (int n = 0; n < kFrame.size(); ++n) closed += floor.closed(kFrame.at(n));
  return closed;
}

TEST(FloorJoin, ARampOfEightDegreesIsGroundAndOneOfTwelveIsNotEnteredAtItsFoot) {
  const FloorJoin gentle = along_x([](double x) { return ramp(x, 8.0); });
  EXPECT_EQ(closed_cells(gentle), 0);
  EXPECT_EQ(gentle.level({-5, 0}), 0);
  EXPECT_EQ(gentle.level({50, 0}), 7);  // 0.71 m
  EXPECT_NEAR(gentle.height({50, 0}), 0.71, 0.01);
  const FloorJoin steep = along_x([](double x) { return ramp(x, 12.0); });
  for (int i = -20; i < 60; ++i) EXPECT_EQ(steep.closed({i, 0}), i >= 0) << i;
  EXPECT_EQ(steep.level({50, 0}), 0);
  // Nor is what only a steep ramp leads to; once it is gentle, it is.
  const auto platform = [](double degrees) {
    return [degrees](double x) { return std::min(0.5, ramp(x, degrees)); };
  };
  FloorJoin above = along_x(platform(12.0));
  EXPECT_FALSE(above.closed({50, 0}));
  EXPECT_EQ(above.level({50, 0}), 0);
  above.look(all_cells(), surfaces_along_x(platform(8.0)));
  EXPECT_EQ(above.level({50, 0}), 5);
  above.look(all_cells(), surfaces_along_x(platform(12.0)));
  EXPECT_EQ(above.level({50, 0}), 0);
}

TEST(FloorJoin, AThresholdIsGroundUpToTheStep) {
  const auto threshold = [](double height) {
    return along_x([height](double x) { return x > 1.0 && x < 1.3 ? height : 0.0; });
  };
  EXPECT_EQ(closed_cells(threshold(0.05)), 0);
  const FloorJoin high = threshold(0.08);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(high.closed({i, 0}), i >= 10 && i <= 12) << i;
}

// That a ramp is uneven does not lift a kerb over a lower step.
TEST(FloorJoin, AKerbIsNoGroundOfARobotWithALowerStep) {
  FloorJoin floor(kR, 1, 0.02);
  floor.look(all_cells(), [](Cell c, std::vector<FloorSurface>& found) {
    if (!kFrame.contains(c)) return;
    const bool kerb = c.i >= 10 && c.i <= 12;
    found.push_back({kerb ? 0 : -1, kerb ? 0.04 : 0.0, true, kerb});
  });
  for (int i = 0; i < 20; ++i) EXPECT_EQ(floor.closed({i, 0}), i >= 10 && i <= 12) << i;
  FloorJoin ramped(kR, 1, 0.02);
  ramped.look(all_cells(), surfaces_along_x([](double x) { return ramp(x, 8.0); }));
  EXPECT_EQ(closed_cells(ramped), 0);
}

TEST(FloorJoin, AnEdgeClosesTheCellAboveItAlone) {
  // Up a ramp, over a platform, down the edge of its end.
  const FloorJoin dock =
      along_x([](double x) { return x > 4.5 ? 0.0 : std::min(0.4, ramp(x, 8.0)); });
  EXPECT_EQ(dock.level({44, 0}), 4);
  EXPECT_EQ(dock.level({45, 0}), 0);
  EXPECT_TRUE(dock.closed({44, 0}));
  EXPECT_FALSE(dock.closed({45, 0}));
  EXPECT_FALSE(dock.closed({40, 0}));
  // What only an edge leads to is no floor; where none is seen, the level is that beside it.
  const FloorJoin shelf = along_x([](double x) {
    return x > 4.5 ? std::nan("") : x > 3.0 ? 0.4 : 0.0;
  });
  EXPECT_TRUE(std::isnan(shelf.height({35, 0})));
  EXPECT_EQ(closed_cells(shelf), 0);
  const FloorJoin half = along_x([](double x) { return x > 3.0 ? std::nan("") : ramp(x, 8.0); });
  EXPECT_EQ(half.level({29, 0}), 4);
  EXPECT_EQ(half.level({29 + FloorJoin::kSpread, 0}), 4);
  EXPECT_EQ(half.level({30 + FloorJoin::kSpread, 0}), 0);
}

TEST(FloorJoin, WhatIsSeenBitByBitIsWhatIsSeenAtOnce) {
  const auto dock = [](double x) { return x > 4.5 ? 0.0 : std::min(0.4, ramp(x, 8.0)); };
  const FloorJoin whole = along_x(dock);
  // A metre more at a time, from above down, and from below up.
  for (const bool up : {true, false}) {
    FloorJoin floor(kR, 1, kStep);
    for (int metre = 1; metre <= 8; ++metre) {
      const auto seen = surfaces_along_x([&](double x) {
        return (up ? x < metre - 2.0 : x > 6.0 - metre) ? dock(x) : std::nan("");
      });
      floor.look(all_cells(), seen);
    }
    for (int n = 0; n < kFrame.size(); ++n) {
      const Cell c = kFrame.at(n);
      EXPECT_EQ(floor.level(c), whole.level(c)) << c.i << ' ' << c.j;
      EXPECT_EQ(floor.closed(c), whole.closed(c)) << c.i << ' ' << c.j;
    }
  }
}

TEST(FloorJoin, WhatHasGrownFromGroundGoesWithIt) {
  FloorJoin floor = along_x([](double x) { return ramp(x, 8.0); });
  EXPECT_EQ(floor.level({50, 0}), 7);
  // A gap over the ramp, all over: nothing joins what is beyond.
  const auto gap =
      surfaces_along_x([](double x) { return x > 2.0 && x < 2.3 ? std::nan("") : ramp(x, 8.0); });
  std::vector<Cell> changed;
  for (int j = -10; j < 10; ++j) {
    for (int i = 20; i < 23; ++i) changed.push_back({i, j});
  }
  floor.look(changed, gap);
  EXPECT_TRUE(std::isnan(floor.height({50, 0})));
  EXPECT_EQ(floor.level({50, 0}), 0);
  EXPECT_NEAR(floor.height({15, 0}), 0.218, 0.01);
  EXPECT_FALSE(floor.changed().empty());
  floor.look(changed, surfaces_along_x([](double x) { return ramp(x, 8.0); }));
  EXPECT_EQ(floor.level({50, 0}), 7);
  floor.look(changed, surfaces_along_x([](double x) { return ramp(x, 8.0); }));
  EXPECT_TRUE(floor.changed().empty());
}

TEST(FloorJoin, NoiseAtTheFootOfAWallIsNoGroundAndNoStep) {
  FloorJoin floor(kR, 1, kStep);
  floor.look(all_cells(), [&](Cell c, std::vector<FloorSurface>& found) {
    if (c.i == 10) found.push_back({0, 0.08, false, false});
    if (c.i < 10) found.push_back({-1, 0.0, true, false});
  });
  EXPECT_TRUE(floor.is_flat());
}

TEST(FloorJoin, AGalleryOverAHallIsNotTheHallsFloor) {
  FloorJoin floor(kR, 1, kStep);
  floor.look(all_cells(), [&](Cell c, std::vector<FloorSurface>& found) {
    found.push_back({-1, 0.0, true, false});
    if (c.i > 10) found.push_back({29, 3.0, true, false});
  });
  EXPECT_TRUE(floor.is_flat());
  EXPECT_EQ(floor.level({30, 0}), 0);
  EXPECT_EQ(closed_cells(floor), 0);
}

}  // namespace
}  // namespace prospect::floor_join_test
