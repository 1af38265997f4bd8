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

/// Floor of a height that is a function of x, all over the frame; NaN: none.
FloorJoin along_x(const std::function<double(double)>& height) {
  return FloorJoin(kFrame, 0, kStep, [&](Cell c, std::vector<FloorSurface>& found) {
    const double z = height(kFrame.center(c).x());
    if (!std::isnan(z)) found.push_back({static_cast<int>(std::ceil(z / kR)) - 1, z});
  });
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
  for (int i = -20; i < 60; ++i) EXPECT_EQ(steep.closed({i, 0}), i >= 1) << i;
}

TEST(FloorJoin, AThresholdIsGroundUpToTheStep) {
  const auto threshold = [](double height) {
    return along_x([height](double x) { return x > 1.0 && x < 1.3 ? height : 0.0; });
  };
  EXPECT_EQ(closed_cells(threshold(0.05)), 0);
  const FloorJoin high = threshold(0.08);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(high.closed({i, 0}), i == 10 || i == 12) << i;
}

TEST(FloorJoin, AnEdgeClosesTheCellAboveItAlone) {
  // Up a ramp, over a platform, down the edge of its end.
  const FloorJoin dock =
      along_x([](double x) { return x > 4.5 ? 0.0 : std::min(0.4, ramp(x, 8.0)); });
  EXPECT_EQ(dock.level({44, 0}), 3);
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
  EXPECT_EQ(half.level({40, 0}), half.level({29, 0}));
}

TEST(FloorJoin, AGalleryOverAHallIsNotTheHallsFloor) {
  const FloorJoin floor(kFrame, 0, kStep, [&](Cell c, std::vector<FloorSurface>& found) {
    found.push_back({-1, 0.0});
    if (c.i > 10) found.push_back({29, 3.0});
  });
  EXPECT_EQ(floor.level({30, 0}), 0);
  EXPECT_EQ(floor.height({30, 0}), 0.0F);
  EXPECT_EQ(closed_cells(floor), 0);
}

}  // namespace
}  // namespace prospect::floor_join_test
