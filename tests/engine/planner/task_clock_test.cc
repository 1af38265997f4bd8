// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/task_clock.h"

#include <gtest/gtest.h>

namespace prospect::task_clock_test {
namespace {

TEST(TaskClock, TellsWhenAnotherTaskBeganAndHowLongTheRobotDidNotExplore) {
  TaskClock clock;
  clock.update(1.0, TaskKind::kExplore);
  clock.update(2.0, TaskKind::kExplore);
  EXPECT_LT(clock.given_at(), -1e300) << "it began with its task";
  EXPECT_EQ(clock.away(), 0.0);
  clock.restart();
  clock.update(3.0, TaskKind::kGoTo);
  EXPECT_EQ(clock.given_at(), 3.0);
  EXPECT_EQ(clock.away(), 1.0);
  clock.update(5.5, TaskKind::kGoTo);
  EXPECT_EQ(clock.given_at(), 3.0);
  EXPECT_EQ(clock.away(), 3.5);
  clock.update(4.0, TaskKind::kGoTo);  // a stamp from before
  EXPECT_EQ(clock.away(), 3.5);
  clock.restart();
  clock.update(6.0, TaskKind::kExplore);
  EXPECT_EQ(clock.given_at(), 6.0);
  EXPECT_EQ(clock.away(), 3.5);
}

}  // namespace
}  // namespace prospect::task_clock_test
