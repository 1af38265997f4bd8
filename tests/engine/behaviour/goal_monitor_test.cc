// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/goal_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace prospect::goal_monitor_test {
namespace {

/// V to a goal at the origin, on a way that is longer than a straight one.
GoalMonitor::CostToGoAt way(double longer = 0.0) {
  return [longer](const Eigen::Vector2d& p) { return p.norm() + longer; };
}

TEST(GoalMonitor, TimeRunsUntilTheRobotIsNearerOrSeesMore) {
  GoalMonitor monitor;
  monitor.update(0.0, {5, 0}, way(), 10.0, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
  monitor.update(2.5, {5, 0}, way(), 10.05, true);
  EXPECT_EQ(monitor.stalled_for(), 2.5);
  EXPECT_FALSE(monitor.stalled());
  monitor.update(3.0, {5, 0}, way(-1.0), 10.05, true);
  EXPECT_TRUE(monitor.stalled()) << "a way that is shorter from where it stands is no progress";
  monitor.update(3.5, {4.7, 0}, way(), 10.05, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
  monitor.update(5.5, {4.7, 0}, way(), 10.2, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0) << "newly seen";
  monitor.update(7.5, {4.7, 0}, way(), 10.2, false);
  EXPECT_EQ(monitor.stalled_for(), 0.0) << "it had something else to do";
  monitor.update(15.5, {4.7, 0}, way(), 10.2, true);
  EXPECT_TRUE(monitor.hopeless());
  monitor.restart();
  monitor.update(16.0, {6, 0}, way(), 10.2, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
  monitor.update(16.5, {5.7, 0}, way(), 10.2, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0) << "on another way its nearest place is another";
}

// However far it strays meanwhile: what it gave away and regains is no progress.
TEST(GoalMonitor, WhoOscillatesOrCirclesNearItsGoalMakesNone) {
  for (const double radius : {0.3, 0.6, 2.0}) {
    GoalMonitor oscillates, circles;
    double t = 0.0;
    for (; t <= 8.0; t += 0.25) {
      const double phase = 1.7 * t;
      oscillates.update(t, {1.0 + radius * (1.0 - std::cos(phase)), 0.0}, way(), 10.0, true);
      // About a place beside the goal.
      circles.update(t, {1.0 + radius * (1.0 - std::cos(phase)), radius * std::sin(phase)}, way(),
                     10.0, true);
    }
    EXPECT_TRUE(oscillates.hopeless()) << radius << " m: " << oscillates.stalled_for() << " s";
    EXPECT_TRUE(circles.stalled()) << radius << " m: " << circles.stalled_for() << " s";
  }
}

// What it sees begins its time anew, and not what counts as nearer.
TEST(GoalMonitor, ANearestPlaceStaysThatOfTheWay) {
  GoalMonitor monitor;
  monitor.update(0.0, {1, 0}, way(), 10.0, true);
  monitor.update(1.0, {3, 0}, way(), 10.2, true);
  monitor.update(3.0, {1.5, 0}, way(), 10.2, true);
  EXPECT_EQ(monitor.stalled_for(), 2.0);
  monitor.follow([](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x() + 1.0, p.y()); });
  monitor.update(3.5, {1.7, 0}, way(), 10.2, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0) << "the place is 2 m from the goal now";
}

TEST(GoalMonitor, ALongerWayIsMeasuredByWhatItCosts) {
  GoalMonitor monitor;
  monitor.update(0.0, {2, 0}, way(), 0.0, true);
  monitor.update(2.0, {3, 0}, way(4.0), 0.0, true);
  EXPECT_EQ(monitor.stalled_for(), 2.0);
  // The nearest place lies behind what is closed now: V says nothing there.
  const auto closed = [](const Eigen::Vector2d& p) {
    return p.x() < 2.5 ? std::numeric_limits<double>::infinity() : 10.0 - p.x();
  };
  monitor.update(2.5, {3, 0}, closed, 0.0, true);
  EXPECT_EQ(monitor.stalled_for(), 2.5);
  monitor.update(3.0, {3.3, 0}, closed, 0.0, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
}

}  // namespace
}  // namespace prospect::goal_monitor_test
