// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/retreat.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/engine/ground_worlds.h"

namespace prospect::retreat_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Traversability of(const GroundMap& map) {
  Traversability t{TraversabilityOptions{.narrow_slack = 0.0}};
  t.update(map);
  return t;
}

/// An all-free map of 12 x 12 m around the origin.
GroundMap open_ground() {
  GroundMap map(GridFrame{0.1, -64, -64, 128, 128});
  for (int i = 0; i < map.frame().size(); ++i) map.set(map.frame().at(i), CellState::kFree);
  return map;
}

TEST(RetreatTrail, NotesOnePlaceASpacing) {
  RetreatTrail trail;
  for (int n = 0; n <= 1000; ++n) trail.note({0.001 * n, 0.0}, n, 0.3);
  ASSERT_EQ(trail.places().size(), 4u);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_NEAR((trail.places()[i] - trail.places()[i - 1]).norm(), 0.3, 1e-3);
  }
  trail.note({kNan, 0.0}, 50);
  trail.note({0.0, std::numeric_limits<double>::infinity()}, 50);
  EXPECT_EQ(trail.places().size(), 4u);
  EXPECT_EQ(trail.tracked_at_newest(), 900) << "noted with the newest place";
  EXPECT_EQ(RetreatTrail().tracked_at_newest(), 0);
}

TEST(RetreatTrail, HasNothingToOfferWithoutPlaces) {
  const Traversability t = of(open_ground());
  EXPECT_EQ(RetreatTrail().cost_to_go(t, {0, 0}, 0.6), nullptr);
  RetreatTrail trail;
  trail.note({50.0, 50.0}, 50);  // beyond reach
  EXPECT_EQ(trail.cost_to_go(t, {0, 0}, 0.6), nullptr);
  trail.note({1.0, 0.0}, 50);
  EXPECT_EQ(trail.cost_to_go(t, {kNan, 0}, 0.6), nullptr);
  EXPECT_NE(trail.cost_to_go(t, {0, 0}, 0.6), nullptr);
}

TEST(RetreatTrail, LeadsToAPlaceThatIsNotHere) {
  const Traversability t = of(open_ground());
  RetreatTrail trail;
  trail.note({2.0, 0.0}, 50);
  trail.note({0.1, 0.1}, 50);  // where the robot stands: going there would change nothing
  const auto V = trail.cost_to_go(t, {0, 0}, 0.5);
  ASSERT_NE(V, nullptr);
  Eigen::Vector2d gradient;
  const double here = V->value(Eigen::Vector2d(0.05, 0.05), gradient);
  EXPECT_NEAR(here, 2.0 / 0.5, 0.4);  // seconds
  EXPECT_LT(gradient.x(), -0.5);
  EXPECT_NEAR(gradient.y(), 0.0, 0.5);
  // If all places are near, the nearest will do.
  RetreatTrail near;
  near.note({0.2, 0.0}, 50);
  ASSERT_NE(near.cost_to_go(t, {0, 0}, 0.5), nullptr);
  EXPECT_LT(near.cost_to_go(t, {0, 0}, 0.5)->value(0.25, 0.05), 0.2);
}

/// On open ground the value is the octile distance, the shortest path over 8 neighbours.
TEST(RetreatTrail, IsTheShortestPathOnOpenGround) {
  const Traversability t = of(open_ground());
  RetreatTrail trail;
  trail.note({1.05, -0.45}, 50);
  const auto V = trail.cost_to_go(t, {0, 0}, 1.0, 0.5, 4.0);
  const GridFrame& f = V->frame();
  const Cell goal = f.cell(1.05, -0.45);
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    const int dx = std::abs(c.i - goal.i), dy = std::abs(c.j - goal.j);
    const double octile = 0.1 * (std::max(dx, dy) + (M_SQRT2 - 1.0) * std::min(dx, dy));
    ASSERT_NEAR(V->cells()[c], octile, 1e-9);
  }
}

TEST(RetreatTrail, GoesAroundWalls) {
  GroundMap map = open_ground();
  for (int j = -20; j < 64; ++j) map.set({10, j}, CellState::kOccupied);  // a wall, open below
  const Traversability t = of(map);
  RetreatTrail trail;
  trail.note({2.0, 0.0}, 50);
  const auto V = trail.cost_to_go(t, {0, 0}, 1.0);
  // Straight through would be 2 m; two cells of wall and their margins at threefold cost, about 1
  // m, are cheaper than 4.5 m around, but nowhere is it cheaper than the straight line.
  EXPECT_GT(V->value(0.05, 0.05), 2.0);
  EXPECT_LT(V->value(0.05, 0.05), 4.6);
}

TEST(RetreatTrail, IsFiniteEverywhereOnAnyMap) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    GroundMap map(GridFrame{0.1, -32, -32, 64, 64});
    test::scribble(map, 60, 80, -40, random);
    const Traversability t = of(map);
    RetreatTrail trail;
    const auto place = [&] { return std::uniform_real_distribution<double>(-5, 5)(random); };
    for (int n = 0; n < 10; ++n) trail.note({place(), place()}, 50);
    const auto V = trail.cost_to_go(t, {place(), place()}, 0.6);
    if (!V) continue;
    for (const double value : V->cells().data) {
      ASSERT_TRUE(std::isfinite(value));
      ASSERT_GE(value, 0.0);
    }
    ASSERT_TRUE(std::isfinite(V->value(1e5, -1e5)));
  }
}

}  // namespace
}  // namespace prospect::retreat_test
