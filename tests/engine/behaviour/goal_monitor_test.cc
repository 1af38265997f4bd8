// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/goal_monitor.h"

#include <gtest/gtest.h>

namespace prospect::goal_monitor_test {
namespace {

TEST(GoalMonitor, TimeRunsUntilTheRobotIsNearerOrSeesMore) {
  GoalMonitor monitor;
  monitor.update(0.0, {0, 0}, 5.0, 10.0, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
  monitor.update(2.5, {0, 0}, 5.0, 10.05, true);
  EXPECT_EQ(monitor.stalled_for(), 2.5);
  EXPECT_FALSE(monitor.stalled());
  monitor.update(3.0, {0, 0}, 4.0, 10.05, true);
  EXPECT_TRUE(monitor.stalled()) << "a way that is shorter from where it stands is no progress";
  monitor.update(3.5, {0.3, 0}, 4.7, 10.05, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
  monitor.update(5.5, {0.3, 0}, 4.7, 10.2, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0) << "newly seen";
  monitor.update(7.5, {0.3, 0}, 4.7, 10.2, false);
  EXPECT_EQ(monitor.stalled_for(), 0.0) << "it had something else to do";
  monitor.update(15.5, {0.3, 0}, 4.7, 10.2, true);
  EXPECT_TRUE(monitor.hopeless());
  monitor.restart();
  monitor.update(16.0, {0.3, 0}, 9.0, 10.2, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
}

TEST(GoalMonitor, ALongerPathIsMeasuredAnewOnTheSameClock) {
  GoalMonitor monitor;
  monitor.update(0.0, {0, 0}, 2.0, 0.0, true);
  monitor.update(2.0, {1, 0}, 6.0, 0.0, true);
  EXPECT_EQ(monitor.stalled_for(), 2.0);
  monitor.update(2.5, {2, 0}, 5.7, 0.0, true);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
}

}  // namespace
}  // namespace prospect::goal_monitor_test
