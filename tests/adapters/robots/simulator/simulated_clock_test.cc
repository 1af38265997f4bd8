// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulated_clock.h"

#include <gtest/gtest.h>

#include <chrono>
#include <mutex>
#include <string>
#include <thread>

namespace prospect::simulated_clock_test {
namespace {

TEST(SimulatedClock, OfOneThreadGoesOnAtOnce) {
  const SimulatedClock clock(1, 5.0);
  EXPECT_EQ(clock.now(), 5.0);
  EXPECT_TRUE(clock.wait_until(3600.0, {}));
  EXPECT_EQ(clock.now(), 3600.0);
  EXPECT_TRUE(clock.wait_until(10.0, {}));  // has come
  EXPECT_EQ(clock.now(), 3600.0);
}

TEST(SimulatedClock, ThreadsTakeTurnsInOrderOfTheirTimes) {
  const SimulatedClock clock(2);
  std::mutex mutex;
  std::string order;
  const auto came = [&] {
    const std::lock_guard lock(mutex);
    return order;
  };
  const auto every = [&](double period, double end, char name, const std::stop_token& stop) {
    for (double time = period; time <= end; time += period) {
      clock.wait_until(time, {});
      const std::lock_guard lock(mutex);
      EXPECT_EQ(clock.now(), time);
      order += name;
    }
    // Whoever has left does not wait, and would hold the other one up.
    clock.wait_until(100.0, stop);
  };
  {
    std::jthread slow([&](const std::stop_token& stop) { every(2.5, 7.5, 's', stop); });
    std::jthread quick([&](const std::stop_token& stop) { every(1.0, 6.0, 'q', stop); });
    while (came().size() < 9) std::this_thread::yield();
  }
  EXPECT_EQ(order, "qqsqqsqqs");  // at 5 s slow has waited for longer
}

TEST(SimulatedClock, WhoBeginsOnceOthersWaitComesAfterThem) {
  const SimulatedClock clock(2);
  std::mutex mutex;
  std::string order;
  const auto comes = [&](char name, const std::stop_token& stop) {
    for (double time = 1.0; time <= 3.0; time += 1.0) {
      clock.wait_until(time, {});
      const std::lock_guard lock(mutex);
      order += name;
    }
    clock.wait_until(100.0, stop);
  };
  {
    std::jthread second([&](const std::stop_token& stop) {
      clock.until_waited_for(1);
      comes('b', stop);
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // it would be there first
    EXPECT_EQ(clock.now(), 0.0);
    std::jthread first([&](const std::stop_token& stop) { comes('a', stop); });
    const auto all_came = [&] {
      const std::lock_guard lock(mutex);
      return order.size() == 6;
    };
    while (!all_came()) std::this_thread::yield();
  }
  EXPECT_EQ(order, "ababab");
}

TEST(SimulatedClock, AStopRequestEndsAWaitThatNothingElseEnds) {
  const SimulatedClock clock(2);
  bool came = true;
  {
    std::jthread waits([&](const std::stop_token& stop) { came = clock.wait_until(1.0, stop); });
  }
  EXPECT_FALSE(came);
  EXPECT_EQ(clock.now(), 0.0);
}

}  // namespace
}  // namespace prospect::simulated_clock_test
