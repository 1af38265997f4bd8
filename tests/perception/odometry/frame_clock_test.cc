// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/frame_clock.h"

#include <gtest/gtest.h>

#include <limits>

namespace prospect::frame_clock_test {
namespace {

TEST(FrameClock, LearnsThePeriodAndNoticesGaps) {
  FrameClock clock(2.5);
  EXPECT_EQ(clock.tick(5.0), "");
  EXPECT_EQ(clock.step(), 0.0);
  EXPECT_EQ(clock.period(), 0.0);
  EXPECT_EQ(clock.tick(5.1), "");
  EXPECT_NEAR(clock.step(), 0.1, 1e-12);
  EXPECT_NEAR(clock.period(), 0.1, 1e-12);
  EXPECT_FALSE(clock.gap());
  EXPECT_EQ(clock.tick(5.4), "");
  EXPECT_TRUE(clock.gap());
  EXPECT_NEAR(clock.period(), 0.11, 1e-12);  // one gap is no new rate
  for (int k = 1; k <= 20; ++k) clock.tick(5.4 + 0.2 * k);
  EXPECT_FALSE(clock.gap());
  EXPECT_NEAR(clock.period(), 0.2, 1e-9);
}

TEST(FrameClock, RefusesStampsThatDoNotIncrease) {
  FrameClock clock;
  EXPECT_EQ(clock.tick(std::numeric_limits<double>::quiet_NaN()), "the time is not a number");
  EXPECT_EQ(clock.tick(1.0), "");
  EXPECT_EQ(clock.tick(1.0), "the time does not increase");
  EXPECT_EQ(clock.tick(0.5), "the time does not increase");
  EXPECT_EQ(clock.tick(1.5), "");  // those before were not taken
  EXPECT_NEAR(clock.step(), 0.5, 1e-12);
}

}  // namespace
}  // namespace prospect::frame_clock_test
