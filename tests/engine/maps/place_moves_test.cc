// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/place_moves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace prospect::place_moves_test {
namespace {

PlaceMoves two() {
  const PlanarMove left{Eigen::Vector2d(0.0, 1.0), 0.0}, right{Eigen::Vector2d(0.5, 0.0), 0.1};
  return PlaceMoves(std::vector<PlaceMoves::Known>{{Eigen::Vector2d(0.0, 0.0), left},
                                                   {Eigen::Vector2d(10.0, 0.0), right}});
}

TEST(PlaceMoves, APlaceGoesWithTheNearest) {
  const PlaceMoves moves = two();
  EXPECT_EQ(moves.now(Eigen::Vector2d(1.0, 2.0)), Eigen::Vector2d(1.0, 3.0));
  const Eigen::Vector2d far(9.0, -1.0);
  EXPECT_EQ(moves.now(far), moves.known()[1].move(far));
  EXPECT_LT((moves.before(moves.now(far)) - far).norm(), 1e-12);
  EXPECT_NEAR(moves.now(Pose{{9.0, 0.0, 0.4}, 1.0}).yaw, 1.1, 1e-12);
  EXPECT_EQ(PlaceMoves(std::vector<PlaceMoves::Known>{}).now(far), far);
}

TEST(PlaceMoves, WhatIsKnownOfCellsGoesWithThem) {
  const PlaceMoves moves = two();
  Grid<int> before(GridFrame{0.1, -20, -20, 140, 60}, 0);
  before[{3, 2}] = 7;
  before[{95, 4}] = 9;
  const Grid<int> now = moved(before, moves, -1);
  EXPECT_EQ(now.frame, before.frame);
  EXPECT_EQ((now[{3, 12}]), 7);
  const Eigen::Vector2d there = moves.now(before.frame.center({95, 4}));
  bool found = false;
  const Cell c = now.frame.cell(there.x(), there.y());
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) found = found || now.get({c.i + i, c.j + j}, 0) == 9;
  }
  EXPECT_TRUE(found);
  EXPECT_EQ((now[{3, -19}]), -1);  // of a place that was outside
}

TEST(PlanarMove, IsAGroup) {
  const PlanarMove a{Eigen::Vector2d(1.0, -2.0), 0.7}, b{Eigen::Vector2d(0.3, 0.4), -1.9};
  const Eigen::Vector2d p(3.0, 5.0);
  EXPECT_LT(((a * b)(p)-a(b(p))).norm(), 1e-12);
  EXPECT_LT(((a.inverse() * a)(p)-p).norm(), 1e-12);
  EXPECT_TRUE(PlanarMove{}.is_none());
  const Pose from{{1.0, 2.0, 0.3}, 0.4}, to{{-2.0, 0.5, 0.3}, 2.0};
  const Pose there = move_between(from, to)(from);
  EXPECT_LT((there.position - to.position).norm(), 1e-12);
  EXPECT_NEAR(there.yaw, to.yaw, 1e-12);
}

// Any place within the radius goes at most so far.
TEST(PlanarMove, KnowsHowFarThingsGo) {
  const PlanarMove a{Eigen::Vector2d(0.02, -0.01), 0.05};
  const Eigen::Vector2d c(4.0, 1.0);
  for (int n = 0; n < 32; ++n) {
    const Eigen::Vector2d p = c + 3.0 * Eigen::Vector2d(std::cos(0.2 * n), std::sin(0.2 * n));
    EXPECT_LE((a(p) - p).norm(), a.farthest(c, 3.0) + 1e-12);
  }
}

}  // namespace
}  // namespace prospect::place_moves_test
