// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/goal_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "tests/engine/ground_worlds.h"
#include "tests/engine/simplest_driver.h"

namespace prospect::goal_planner_test {
namespace {

/// A wall of 3 cells across a room, x from 3.8 to 4 m, with a door if asked for.
GroundMap two_rooms(bool door) {
  GroundMap map = test::known_room(80, [](int) { return false; });
  for (int j = 8; j < 47; ++j) {
    for (int i = 38; i < 41; ++i) {
      if (!door || j < 20 || j >= 32) map.set({i, j}, CellState::kOccupied);
    }
  }
  return map;
}

Goal to(double x, double y) {
  Goal goal;
  goal.position = {x, y};
  return goal;
}

Pose at(double x, double y, double yaw = 0.0) { return {{x, y, 0.0}, yaw}; }

TEST(GoalPlanner, LeadsThroughTheDoor) {
  GoalPlanner frontier_planner({}, to(6.05, 1.55), 2.0);
  const auto g = frontier_planner.update(two_rooms(true), at(1.5, 1.5), 0.0, {});
  ASSERT_TRUE(g->target);
  EXPECT_TRUE(g->frontiers.empty()) << "all of the way is known";
  EXPECT_FALSE(frontier_planner.facts().reached);
  EXPECT_FALSE(frontier_planner.facts().near);
  EXPECT_FALSE(frontier_planner.facts().unreachable);
  EXPECT_EQ(frontier_planner.facts().unknown_left, 0.0);
  EXPECT_GT(frontier_planner.facts().path_left, 4.7);
  EXPECT_LT(frontier_planner.facts().path_left, 6.0);
  EXPECT_NEAR(frontier_planner.facts().distance, 4.55, 0.01);
  const auto path = g->cost_to_go->descend({1.5, 1.5}, 20.0);
  bool through = false;
  for (const Eigen::Vector2d& p : path) {
    through = through || (std::abs(p.x() - 3.95) < 0.1 && p.y() > 2.0 && p.y() < 3.2);
  }
  EXPECT_TRUE(through);
}

TEST(GoalPlanner, ReachedWithinTheTolerancesAndLeftBeyondTwiceThem) {
  Goal goal = to(2.0, 2.0);
  goal.yaw = 1.0;
  GoalPlanner frontier_planner({}, goal, 2.0);
  const GroundMap map = two_rooms(true);
  const auto reached = [&](const Pose& pose) {
    frontier_planner.update(map, pose, 0.0, {});
    return frontier_planner.facts().reached;
  };
  EXPECT_FALSE(reached(at(1.8, 2.0, 1.0)));
  EXPECT_TRUE(frontier_planner.facts().near);
  EXPECT_FALSE(reached(at(1.9, 2.0, 0.8))) << "another heading";
  EXPECT_TRUE(reached(at(1.9, 2.0, 0.9 + 2.0 * M_PI)));
  EXPECT_TRUE(reached(at(1.75, 2.0, 1.2)));
  EXPECT_FALSE(reached(at(1.65, 2.0, 1.0)));
}

TEST(GoalPlanner, SaysWhyThereIsNoWay) {
  const auto why = [](const GroundMap& map, const Goal& goal, const Zones& zones = {}) {
    GoalPlannerOptions options;
    if (!zones.empty()) options.traversability.zones = std::make_shared<const ZoneMap>(zones);
    GoalPlanner frontier_planner(options, goal, 2.0);
    frontier_planner.update(map, at(1.5, 1.5), 0.0, {});
    const auto g = frontier_planner.update(map, at(1.5, 1.5), 2.5, {});
    EXPECT_EQ(frontier_planner.facts().unreachable, !frontier_planner.facts().why.empty());
    EXPECT_EQ(frontier_planner.facts().unreachable, !g->target.has_value());
    EXPECT_EQ(frontier_planner.facts().unreachable_for,
              frontier_planner.facts().unreachable ? 2.5 : 0.0);
    return frontier_planner.facts().why;
  };
  EXPECT_EQ(why(two_rooms(true), to(6, 1.5)), "");
  EXPECT_NE(why(two_rooms(true), to(3.95, 1.05)).find("in a wall"), std::string::npos);
  Goal exact = to(6.65, 1.05);  // 0.05 m from a wall, whose inner face is at x = 6.7
  exact.position_tolerance = 0.05;
  EXPECT_NE(why(two_rooms(true), exact).find("0.05 m from an obstacle"), std::string::npos);
  EXPECT_NE(why(two_rooms(false), to(6, 1.5)).find("closes every way"), std::string::npos);
  Zones zones;
  zones.keep_out = {{{5.5, 1.0}, {6.5, 1.0}, {6.5, 2.0}, {5.5, 2.0}}};
  EXPECT_EQ(why(two_rooms(true), to(6, 1.5), zones), "it is in zones.keep_out[0]");
  zones.keep_out = {};
  zones.bound = Polygon{{0, 0}, {5, 0}, {5, 5}, {0, 5}};
  EXPECT_EQ(why(two_rooms(true), to(6, 1.5), zones), "it is beyond zones.bound");
  zones.bound.reset();
  zones.keep_out = {{{3.5, 0.0}, {4.5, 0.0}, {4.5, 5.0}, {3.5, 5.0}}};  // over wall and door
  EXPECT_EQ(why(two_rooms(true), to(6, 1.5), zones), "zones.keep_out[0] bars every way there");
  EXPECT_NE(why(two_rooms(false), to(6, 1.5), zones).find("walls closes every way"),
            std::string::npos)
      << "nor would there be one without";
}

// A heading that cannot be had: the place counts, and what is missing is told.
TEST(GoalPlanner, GivesUpAHeadingAtWhichItGetsLost) {
  Goal goal = to(2.0, 2.0);
  goal.yaw = 2.0;
  const GroundMap map = two_rooms(true);
  double stamp = 0.0;
  const auto after = [&](GoalPlanner& planner, const Pose& pose, bool got_lost) {
    planner.update(map, pose, stamp += 0.5, {.got_lost = got_lost});
    return planner.facts();
  };
  GoalPlanner planner({}, goal, 2.0);
  EXPECT_FALSE(after(planner, at(1.9, 2.0), false).reached);
  EXPECT_FALSE(after(planner, at(3.0, 2.0), true).reached) << "lost elsewhere says nothing";
  EXPECT_FALSE(after(planner, at(3.0, 2.0), true).reached);
  EXPECT_FALSE(after(planner, at(1.9, 2.0, 1.0), true).reached) << "once may be chance";
  EXPECT_FALSE(after(planner, at(1.9, 2.0, 1.0), false).reached);
  const GoalFacts lost = after(planner, at(1.9, 2.0, 1.2), true);
  EXPECT_TRUE(lost.reached);
  ASSERT_TRUE(lost.heading_missed);
  EXPECT_NEAR(*lost.heading_missed, 0.8, 1e-12);
  EXPECT_NE(lost.heading_why.find("localization"), std::string::npos);
  EXPECT_FALSE(after(planner, at(3.0, 2.0), false).reached) << "the place still counts";
  // Nor one to which it does not get round.
  GoalPlanner stuck({}, goal, 2.0);
  for (int n = 0; n < 40; ++n) EXPECT_FALSE(after(stuck, at(1.9, 2.0, 1.0), false).reached) << n;
  EXPECT_TRUE(after(stuck, at(1.9, 2.0, 1.0), false).reached);
  EXPECT_NE(stuck.facts().heading_why.find("round"), std::string::npos);
  // One that can be had is waited for.
  GoalPlanner turning({}, goal, 2.0);
  for (int n = 0; n < 18; ++n) {
    EXPECT_FALSE(after(turning, at(1.9, 2.0, 2.0 - 1.9 + 0.1 * n), false).reached) << n;
  }
  EXPECT_TRUE(after(turning, at(1.9, 2.0, 2.0), false).reached);
  EXPECT_FALSE(turning.facts().heading_missed);
}

// Beyond the map as well: a robot in a corridor goes where the goal lies, looking.
TEST(GoalPlanner, ReachesAGoalInTheUnknown) {
  std::mt19937_64 random(3);
  const test::GroundWorld world = test::GroundWorld::rooms(16.0, 0.1, 6, random);
  for (int run = 0; run < 4; ++run) {
    const Cell from = world.open_cell(5, random), goal_cell = world.open_cell(5, random);
    const Eigen::Vector2d start = world.truth.frame.center(from);
    Goal goal;
    goal.position = world.truth.frame.center(goal_cell);
    GoalPlanner frontier_planner({}, goal, 2.0);
    GroundMap map(GridFrame{0.1, from.i, from.j, 1, 1});
    Pose pose = at(start.x(), start.y());
    int steps = 0;
    bool unknown = false;
    for (; steps < 600 && !frontier_planner.facts().reached; ++steps) {
      world.sense(pose, 3.5, 1.2, map);
      const auto g = frontier_planner.update(map, pose, 0.5 * steps, {});
      if (frontier_planner.facts().unreachable) break;
      unknown = unknown || !g->frontiers.empty();
      for (const Frontier& f : g->frontiers) {
        for (const Cell c : f.cells) ASSERT_EQ(map.state(c), CellState::kUnknown);
      }
      if (!frontier_planner.facts().reached) test::follow(*g, pose);
      ASSERT_FALSE(world.occupied(world.truth.frame.cell(pose.position.x(), pose.position.y())));
    }
    EXPECT_TRUE(frontier_planner.facts().reached || frontier_planner.facts().unreachable)
        << run << ": " << steps;
    if (frontier_planner.facts().unreachable) {
      // True only if no path of the true plan leads there.
      GroundMap all(world.truth.frame);
      for (int k = 0; k < world.truth.frame.size(); ++k) {
        all.set(world.truth.frame.at(k), world.truth.data[static_cast<std::size_t>(k)]);
      }
      GoalPlanner knows({}, goal, 2.0);
      knows.update(all, at(start.x(), start.y()), 0.0, {});
      EXPECT_TRUE(knows.facts().unreachable) << run << ": " << frontier_planner.facts().why;
    }
    EXPECT_TRUE(unknown);
  }
}

// The door is not seen: unknown cells that no observation makes known. Held up there, it gives that
// way up.
TEST(GoalPlanner, GivesUpAWayThatItCannotGet) {
  GroundMap map = two_rooms(true);
  for (int j = 20; j < 32; ++j) {
    for (int i = 38; i < 41; ++i) map.set({i, j}, CellState::kUnknown);
  }
  GoalPlanner frontier_planner({}, to(6, 1.5), 2.0);
  const Pose pose = at(3.3, 2.6);
  double t = 0.0;
  frontier_planner.update(map, pose, t, {});
  EXPECT_FALSE(frontier_planner.facts().unreachable);
  while (!frontier_planner.facts().unreachable && t < 120.0) {
    t += 0.5;
    frontier_planner.update(map, pose, t, {.pursued = false});
    ASSERT_EQ(frontier_planner.facts().stalled_for, 0.0) << "it had something else to do";
    if (t >= 10.0) break;
  }
  while (!frontier_planner.facts().unreachable && t < 120.0) {
    t += 0.5;
    frontier_planner.update(map, pose, t, {});
    EXPECT_TRUE(t != 13.5 || frontier_planner.facts().stalled);
  }
  EXPECT_LT(t, 60.0);
  EXPECT_NE(frontier_planner.facts().why.find("could not be passed or seen"), std::string::npos)
      << frontier_planner.facts().why;
}

// What it gives away and regains is no progress, however far it goes.
TEST(GoalPlanner, WhoGoesToAndFroBeforeItsGoalIsStalled) {
  GoalPlanner planner({}, to(6, 1.5), 2.0);
  const GroundMap map = two_rooms(true);
  for (double t = 0.0; t <= 6.0; t += 0.5) {
    planner.update(map, at(2.6 + 0.7 * std::cos(0.5 * M_PI * t), 2.6), t, {});
    EXPECT_EQ(planner.facts().stalled, t >= 3.0) << t;
  }
}

TEST(GoalPlanner, AWayThroughTheKnownIsPreferredByThePrice) {
  // A known detour of twice the straight way, which is unknown.
  GroundMap map = test::known_room(80, [](int) { return false; });
  for (int j = 8; j < 40; ++j) {
    for (int i = 34; i < 44; ++i) map.set({i, j}, CellState::kUnknown);
  }
  for (const auto& [price, unknown] : {std::pair{1.0, true}, {20.0, false}}) {
    GoalPlanner frontier_planner({}, to(6.0, 1.5), price);
    frontier_planner.update(map, at(1.5, 1.5), 0.0, {});
    EXPECT_EQ(frontier_planner.facts().unknown_left > 0.0, unknown) << price;
  }
}

}  // namespace
}  // namespace prospect::goal_planner_test
