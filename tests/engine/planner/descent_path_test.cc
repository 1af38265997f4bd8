// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/descent_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/obstacle_worlds.h"

namespace prospect::descent_path_test {
namespace {

// V falls to the east by 1 s/m, with a ridge in every other row of cells: with it, the gradient
// turns from cell to cell.
CostToGo eastward(double ridge) {
  const GridFrame frame{0.1, 0, 0, 60, 20};
  Grid<double> seconds(frame, 0.0);
  Grid<std::uint8_t> reached(frame, 1);
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    seconds[c] = 6.0 - 0.1 * c.i + (c.j % 2 == 0 ? ridge : 0.0);
  }
  return CostToGo(std::move(seconds), std::move(reached), 0.6);
}

TEST(DescentPath, LeadsTowardsAPointAheadThoughTheGradientTurns) {
  const CostToGo V = eastward(0.4);
  const Eigen::Vector2d from(0.55, 1.02);
  Eigen::Vector2d gradient;
  V.value(from, gradient);
  const double local = std::abs(std::atan2(-gradient.y(), -gradient.x()));
  ASSERT_GT(local, 0.7);
  const DescentPath path(V, from, 3.0);
  EXPECT_LT(std::abs(path.heading(from, 0.5, 2.0)), 0.4 * local);
  // Also from beside the path: back towards it.
  const double back = path.heading(from + Eigen::Vector2d(1.0, 0.3), 0.5, 2.0);
  EXPECT_LT(back, -0.3);
  EXPECT_GT(back, -1.0);
}

TEST(DescentPath, AtItsEndAnyHeadingWillDo) {
  const CostToGo V = eastward(0.0);
  const DescentPath path(V, {0.55, 1.02}, 1.0);
  const double left = path.left({0.55, 1.02});
  EXPECT_NEAR(left, 1.0, 0.2);
  EXPECT_EQ(path.heading({0.55 + left, 1.02}, 0.5, 1.25), 1.25);
  // A path of no length is its own end.
  const DescentPath none(V, {0.55, 1.02}, 0.0);
  EXPECT_EQ(none.heading({0.55, 1.02}, 0.5, -0.5), -0.5);
}

// A wall along y = 0.7 on one side of the path, and another 0.6 m from it.
TEST(DescentPath, InAGapItIsMovedToTheMiddle) {
  test::ObstacleWorld world(0.1, 6.0, 0.6);
  for (int i = 20; i < 40; ++i) {
    for (int j = 0; j < 20; ++j) {
      if (j < 7 || j >= 13) world.occupy_column(i, j);
    }
  }
  const ClearanceField clearance({3.0, 1.0, 0.0}, world.voxels, world.ground, {});
  const CostToGo V = eastward(0.0);
  const Eigen::Vector2d from(0.5, 0.88);
  DescentPath path(V, from, 4.5);
  const auto offset = [&](double x) {
    const Eigen::Vector2d p(x, 0.88);
    return std::tan(path.heading(p, 0.4, 9.0)) * 0.4;
  };
  ASSERT_NEAR(offset(2.5), 0.0, 0.02);
  path.centre(clearance, 0.0, 0.5, 0.15);
  EXPECT_NEAR(offset(2.5), 0.12, 0.03) << "to the middle of the gap, y = 1";
  EXPECT_NEAR(offset(0.7), 0.0, 0.02) << "where there is room it is left alone";
  DescentPath held(V, from, 4.5);
  held.centre(clearance, 0.0, 0.5, 0.05);
  EXPECT_NEAR(std::tan(held.heading({2.5, 0.88}, 0.4, 9.0)) * 0.4, 0.05, 0.015);
}

}  // namespace
}  // namespace prospect::descent_path_test
