// SPDX-License-Identifier: Apache-2.0
#include "engine/support/resumed.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace prospect::resumed_test {
namespace {

constexpr auto kNoTime = Resumable::Clock::time_point::min();
constexpr auto kAllTheTime = Resumable::Clock::time_point::max();

/// That value, after a pause.
auto late(int value) {
  return [value](const PausePoint& pause) {
    pause();
    return value;
  };
}

TEST(Resumed, TheLastWholeResultServesUntilTheNextIsDone) {
  Resumed<int> results;
  EXPECT_FALSE(results.newest().has_value());
  EXPECT_TRUE(results.update(1, late(1), kAllTheTime));
  EXPECT_EQ(results.newest(), 1);
  EXPECT_FALSE(results.update(2, late(2), kNoTime));
  EXPECT_TRUE(results.busy());
  EXPECT_EQ(results.newest(), 1);
  EXPECT_EQ(results.stamp(), 1.0);
  EXPECT_FALSE(results.update(3, late(3), kNoTime)) << "what is done is as it was begun";
  EXPECT_EQ(results.newest(), 2);
  EXPECT_EQ(results.stamp(), 2.0) << "of what it is, however late it is done";
  EXPECT_FALSE(results.busy());
  EXPECT_FALSE(results.update(4, late(4), kNoTime));
  EXPECT_TRUE(results.update(5, late(5), Resumable::Clock::now() + std::chrono::hours(1)));
  EXPECT_EQ(results.newest(), 5) << "with time left the next is begun";
  EXPECT_FALSE(results.go_on(kNoTime)) << "nothing is under way";
  EXPECT_FALSE(results.update(6, late(6), kNoTime));
  EXPECT_TRUE(results.go_on(kNoTime));
  EXPECT_EQ(results.newest(), 6);
  EXPECT_EQ(results.stamp(), 6.0);
}

TEST(Resumed, WhatIsNotWantedAnyMoreIsNotKept) {
  Resumed<int> results;
  EXPECT_TRUE(results.update(1, late(1), kAllTheTime));
  EXPECT_FALSE(results.update(2, late(2), kNoTime));
  results.forget();
  EXPECT_FALSE(results.newest().has_value());
  EXPECT_FALSE(results.update(3, late(3), kNoTime));
  EXPECT_FALSE(results.newest().has_value()) << "2 was of before";
  EXPECT_FALSE(results.update(4, late(4), kNoTime));
  results.give_up();
  EXPECT_FALSE(results.busy());
  EXPECT_TRUE(results.update(5, late(5), kAllTheTime));
  EXPECT_EQ(results.newest(), 5);
  const auto broken = [](const PausePoint&) -> int { throw std::runtime_error("broken"); };
  EXPECT_THROW(results.update(6, broken, kAllTheTime), std::runtime_error);
  EXPECT_THROW(results.update(6, broken, kNoTime), std::runtime_error);
  EXPECT_FALSE(results.busy());
  EXPECT_EQ(results.newest(), 5);
  EXPECT_EQ(results.stamp(), 5.0);
  const auto late_and_broken = [](const PausePoint& pause) -> int {
    pause();
    throw std::runtime_error("broken");
  };
  EXPECT_FALSE(results.update(7, late_and_broken, kNoTime));
  results.forget();
  EXPECT_THROW(results.go_on(kNoTime), std::runtime_error);
  EXPECT_FALSE(results.update(8, late(8), kNoTime));
  EXPECT_TRUE(results.go_on(kNoTime));
  EXPECT_EQ(results.newest(), 8) << "what was not wanted was the one that failed";
}

}  // namespace
}  // namespace prospect::resumed_test
