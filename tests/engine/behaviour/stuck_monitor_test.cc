// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/stuck_monitor.h"

#include <gtest/gtest.h>

#include <limits>

namespace prospect::stuck_monitor_test {
namespace {

const Eigen::Vector2d kPlace(3.0, -2.0);

Eigen::Vector2d off(double metres) { return kPlace + Eigen::Vector2d(0.0, metres); }

TEST(StuckMonitor, BeginsWhenPatienceIsUpAndEndsFarFromThere) {
  StuckMonitor monitor;
  double t = 100.0;
  for (; t <= 100.0 + StuckMonitor::kPatience; t += 0.5) {
    EXPECT_FALSE(monitor.update(t, off(t < 105.0 ? 0.0 : 0.19), true)) << t;
  }
  EXPECT_TRUE(monitor.update(t, kPlace, true));
  EXPECT_TRUE(monitor.update(t += 0.5, off(0.49), true));
  EXPECT_TRUE(monitor.update(t += 0.5, off(0.0), false));
  EXPECT_FALSE(monitor.update(t += 0.5, off(0.51), true));
  EXPECT_FALSE(monitor.update(t += 9.5, off(0.51), true)) << "the clock begins anew";
  EXPECT_TRUE(monitor.update(t += 1.0, off(0.51), true));
}

TEST(StuckMonitor, WhoGetsOnIsInNone) {
  StuckMonitor monitor;
  for (int n = 0; n < 1000; ++n) {
    EXPECT_FALSE(monitor.update(n, off(0.03 * n), true));
  }
}

TEST(StuckMonitor, OnlyTimeCountsInWhichTheRobotTries) {
  StuckMonitor monitor;
  double t = 0.0;
  for (int n = 0; n < 9; ++n) {
    EXPECT_FALSE(monitor.update(t += 1.0, kPlace, true));
    EXPECT_FALSE(monitor.update(t += 60.0, kPlace, false));
  }
  EXPECT_FALSE(monitor.update(t += 1.0, kPlace, true)) << "nine seconds: the first began the clock";
  EXPECT_FALSE(monitor.update(t += 1.0, kPlace, true)) << "ten";
  EXPECT_TRUE(monitor.update(t += 0.1, kPlace, true));
}

TEST(StuckMonitor, WhatIsNotFiniteAndAClockThatGoesBackChangeNothing) {
  StuckMonitor monitor;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(monitor.update(nan, kPlace, true));
  EXPECT_FALSE(monitor.update(0.0, kPlace, true));
  EXPECT_FALSE(monitor.update(5.0, kPlace, true));
  EXPECT_FALSE(monitor.update(1e9, {nan, 0.0}, true));
  EXPECT_FALSE(monitor.update(4.0, kPlace, true));
  EXPECT_FALSE(monitor.update(9.0, kPlace, true)) << "ten seconds are not over";
  EXPECT_TRUE(monitor.update(9.5, kPlace, true));
  EXPECT_TRUE(monitor.update(nan, kPlace, true)) << "as before";
}

}  // namespace
}  // namespace prospect::stuck_monitor_test
