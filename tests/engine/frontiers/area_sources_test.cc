// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/area_sources.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "engine/frontiers/cost_to_go_field.h"
#include "engine/frontiers/goal_planner.h"
#include "engine/frontiers/known_paths.h"

namespace prospect::area_sources_test {
namespace {

/// 4 m of a corridor that is known, 2 m wide, from x = 0; what lies on is unknown.
GroundMap corridor() {
  GroundMap map(GridFrame{0.1, -2, -2, 44, 24});
  for (int i = -2; i < 40; ++i) {
    for (int j = -2; j < 22; ++j) {
      const bool wall = i < 0 || j < 0 || j >= 20;
      map.set({i, j}, wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

TraversabilityOptions through_unknown() {
  TraversabilityOptions options;
  options.unknown_travel = 2.0;
  return options;
}

Polygon box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

TEST(AreaSources, AreTheUnknownOfTheArea) {
  Traversability traversability(through_unknown());
  traversability.update(corridor());
  const auto sources = [&](const Polygon& area) { return AreaSources(traversability, area); };
  const auto at = [&](const AreaSources& s, double x, double y) {
    return s.source(traversability.frame().cell(x, y));
  };
  const AreaSources half = sources(box(3.0, 0.0, 5.0, 2.0));
  EXPECT_EQ(at(half, 4.55, 1.05), 0.0F);
  EXPECT_EQ(at(half, 3.05, 1.05), INFINITY) << "known";
  EXPECT_EQ(at(half, 5.45, 1.05), INFINITY) << "elsewhere";
  EXPECT_NEAR(half.seen(), 2.0, 0.01);
  EXPECT_FALSE(half.nowhere());
  EXPECT_NEAR(sources(box(1.0, 0.5, 3.0, 1.5)).seen(), 2.0, 1e-9);
  // Walls are not seen: nothing free is.
  EXPECT_EQ(sources(box(0.0, -0.2, 3.0, 0.0)).seen(), 0.0);
  // Less than a part is nothing to go to, unless it goes on beyond the map.
  EXPECT_EQ(at(sources(box(4.5, 0.8, 5.0, 1.4)), 4.65, 1.05), INFINITY);
  EXPECT_EQ(at(sources(box(4.5, 0.5, 5.3, 1.5)), 4.65, 1.05), 0.0F);

  // All of it beyond the map: from its rim on, as the crow flies, at the price of the unknown.
  const AreaSources beyond = sources(box(20.0, 0.0, 22.0, 2.0));
  const GridFrame& f = traversability.frame();
  const Cell rim{f.i0 + f.width - 2, 10};
  EXPECT_NEAR(beyond.source(rim), 2.0 * (20.0 - f.center(rim).x()), 1e-4);
  EXPECT_NEAR(beyond.outside({19.0, 1.0}), 1.0, 1e-12);
  EXPECT_FALSE(beyond.nowhere());
  EXPECT_EQ(half.outside({4.0, 1.0}), INFINITY);
}

TEST(AreaSources, WhatIsForbiddenOrOutOfTheWorldDoesNotCount) {
  TraversabilityOptions options = through_unknown();
  options.extent = Eigen::AlignedBox2d(Eigen::Vector2d(-1, -1), Eigen::Vector2d(6, 3));
  Zones zones;
  zones.keep_out = {box(4.0, -2.0, 5.0, 4.0)};
  options.zones = std::make_shared<const ZoneMap>(zones);
  Traversability traversability(options);
  traversability.update(corridor());
  const auto sources = [&](const Polygon& area) { return AreaSources(traversability, area); };
  EXPECT_TRUE(sources(box(7, 0, 9, 2)).beyond_extent());
  EXPECT_TRUE(sources(box(7, 0, 9, 2)).nowhere());
  EXPECT_FALSE(sources(box(4.2, 0, 4.8, 2)).beyond_extent());
  EXPECT_TRUE(sources(box(4.2, 0, 4.8, 2)).nowhere());
  const AreaSources half = sources(box(4.5, 0, 9, 2));  // half in the zone, half out of the world
  const auto at = [&](double x) { return half.source(traversability.frame().cell(x, 1.05)); };
  EXPECT_FALSE(half.nowhere());
  EXPECT_EQ(at(4.75), INFINITY);
  EXPECT_EQ(at(5.55), 0.0F);
  EXPECT_EQ(at(6.55), INFINITY);
}

// The path to an area, step by step: through the unknown to the nearest part of it.
TEST(AreaSources, LeadAGoalPlanner) {
  GoalPlanner planner({}, box(6.0, 0.0, 8.0, 2.0), 2.0);
  const Pose pose{{1.0, 1.0, 0.0}, 0.0};
  const auto plan = planner.update(corridor(), pose, 0.0, {});
  ASSERT_TRUE(plan->target);
  EXPECT_FALSE(planner.facts().unreachable);
  EXPECT_FALSE(planner.facts().reached);
  EXPECT_FALSE(planner.facts().near);
  EXPECT_NEAR(planner.facts().path_left, 5.2, 0.4);
  EXPECT_NEAR(planner.facts().unknown_left, 2.0, 0.4);
  ASSERT_EQ(plan->frontiers.size(), 1u);
  EXPECT_NEAR(plan->target->looks_at.x(), 4.05, 0.1) << "the first unknown cell of the way";
  EXPECT_EQ(planner.seen(), 0.0);
  // What the walls close is out of reach.
  GroundMap closed = corridor();
  for (int j = 0; j < 20; ++j) closed.set({39, j}, CellState::kOccupied);
  GoalPlanner shut({}, box(6.0, 0.0, 8.0, 2.0), 2.0);
  EXPECT_FALSE(shut.update(closed, pose, 0.0, {})->target);
  EXPECT_TRUE(shut.facts().unreachable);
  EXPECT_NE(shut.facts().why.find("walls closes every way"), std::string::npos) << shut.facts().why;
}

TEST(KnownPaths, LeadOverKnownGroundAlone) {
  GroundMap map = corridor();
  const Pose pose{{3.5, 0.5, 0.0}, 0.0};
  const KnownPaths paths(map, pose, {}, {0.5, 0.5});
  EXPECT_NEAR(paths.length_near({3.5, 0.55}), 3.0, 0.6);
  EXPECT_EQ(paths.length_near({5.5, 1.0}), INFINITY) << "unknown";
  const GridFrame frame{0.1, 0, 0, 1, 1};
  const std::vector<Cell> path = paths.path(frame.cell(3.05, 1.05));
  EXPECT_NEAR(frame.center(path.back()).x(), 0.5, 0.2);
  // A wall across, with a gap on the far side, makes it longer; without one there is no path.
  for (int j = 0; j < 13; ++j) map.set({20, j}, CellState::kOccupied);
  EXPECT_GT(KnownPaths(map, pose, {}, {0.5, 0.5}).length_near({3.5, 0.55}), 3.8);
  for (int j = 13; j < 20; ++j) map.set({20, j}, CellState::kOccupied);
  EXPECT_EQ(KnownPaths(map, pose, {}, {0.5, 0.5}).length_near({3.5, 0.55}), INFINITY);
}

}  // namespace
}  // namespace prospect::area_sources_test
