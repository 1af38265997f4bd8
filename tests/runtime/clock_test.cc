// SPDX-License-Identifier: Apache-2.0
#include "runtime/clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

namespace prospect::clock_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(SteadyClock, GoesOnAndWaitsForATime) {
  const SteadyClock clock;
  const double before = clock.now();
  EXPECT_TRUE(clock.wait_until(before + 0.005, {}));
  EXPECT_GE(clock.now(), before + 0.005);
}

TEST(SteadyClock, ATimeThatHasComeIsNotWaitedFor) {
  const SteadyClock clock;
  EXPECT_TRUE(clock.wait_until(clock.now() - 1.0, {}));
  EXPECT_TRUE(clock.wait_until(std::nan(""), {}));
}

TEST(SteadyClock, ARequestToStopEndsAWaitForEver) {
  const SteadyClock clock;
  bool come = true;
  std::jthread waiter(
      [&](const std::stop_token& stop) { come = clock.wait_until(kInfinity, stop); });
  waiter.request_stop();
  waiter.join();
  EXPECT_FALSE(come);
}

TEST(ManualClock, StandsStillUntilItIsSet) {
  ManualClock clock(5.0);
  EXPECT_EQ(clock.now(), 5.0);
  clock.set(6.5);
  EXPECT_EQ(clock.now(), 6.5);
  clock.advance(0.5);
  EXPECT_EQ(clock.now(), 7.0);
}

TEST(ManualClock, NeverGoesBack) {
  ManualClock clock(5.0);
  clock.set(4.0);
  clock.set(std::nan(""));
  clock.set(kInfinity);
  clock.advance(-1.0);
  clock.advance(std::nan(""));
  EXPECT_EQ(clock.now(), 5.0);
}

TEST(ManualClock, WakesWhoWaitsWhenTheTimeHasCome) {
  ManualClock clock;
  double woken_at = -1.0;
  std::jthread waiter([&](const std::stop_token& stop) {
    if (clock.wait_until(2.0, stop)) woken_at = clock.now();
  });
  clock.set(1.0);
  clock.set(2.0);
  waiter.join();
  EXPECT_EQ(woken_at, 2.0);
}

TEST(ManualClock, ARequestToStopEndsAWait) {
  const ManualClock clock;
  bool come = true;
  std::jthread waiter([&](const std::stop_token& stop) { come = clock.wait_until(1.0, stop); });
  waiter.request_stop();
  waiter.join();
  EXPECT_FALSE(come);
}

}  // namespace
}  // namespace prospect::clock_test
