// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/exhaustion_monitor.h"

#include <gtest/gtest.h>

namespace prospect::exhaustion_monitor_test {
namespace {

TEST(ExhaustionMonitor, CountsTheTimeInWhichTheRobotLooked) {
  ExhaustionMonitor monitor;
  EXPECT_EQ(monitor.update(0.0, {false, true}), 0.0);
  EXPECT_EQ(monitor.update(1.0, {true, true}), 0.0);
  EXPECT_EQ(monitor.update(3.0, {true, true}), 2.0);
  EXPECT_EQ(monitor.update(13.0, {true, false}), 2.0) << "it had something else to do";
  EXPECT_EQ(monitor.update(14.0, {true, true}), 3.0);
  EXPECT_EQ(monitor.update(15.0, {false, true}), 0.0);
  EXPECT_EQ(monitor.update(16.0, {true, true}), 0.0);
  EXPECT_EQ(monitor.update(2.0, {true, true}), 0.0) << "a clock that jumps back";
}

}  // namespace
}  // namespace prospect::exhaustion_monitor_test
