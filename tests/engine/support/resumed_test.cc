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
  EXPECT_TRUE(results.update(late(1), kAllTheTime));
  EXPECT_EQ(results.newest(), 1);
  EXPECT_FALSE(results.update(late(2), kNoTime));
  EXPECT_TRUE(results.busy());
  EXPECT_EQ(results.newest(), 1);
  EXPECT_FALSE(results.update(late(3), kNoTime)) << "what is done is as it was begun";
  EXPECT_EQ(results.newest(), 2);
  EXPECT_FALSE(results.busy());
  EXPECT_FALSE(results.update(late(4), kNoTime));
  EXPECT_TRUE(results.update(late(5), Resumable::Clock::now() + std::chrono::hours(1)));
  EXPECT_EQ(results.newest(), 5) << "with time left the next is begun";
}

TEST(Resumed, WhatIsNotWantedAnyMoreIsNotKept) {
  Resumed<int> results;
  EXPECT_TRUE(results.update(late(1), kAllTheTime));
  EXPECT_FALSE(results.update(late(2), kNoTime));
  results.forget();
  EXPECT_FALSE(results.newest().has_value());
  EXPECT_FALSE(results.update(late(3), kNoTime));
  EXPECT_FALSE(results.newest().has_value()) << "2 was of before";
  EXPECT_FALSE(results.update(late(4), kNoTime));
  results.give_up();
  EXPECT_FALSE(results.busy());
  EXPECT_TRUE(results.update(late(5), kAllTheTime));
  EXPECT_EQ(results.newest(), 5);
  const auto broken = [](const PausePoint&) -> int { throw std::runtime_error("broken"); };
  EXPECT_THROW(results.update(broken, kAllTheTime), std::runtime_error);
  EXPECT_THROW(results.update(broken, kNoTime), std::runtime_error);
  EXPECT_FALSE(results.busy());
  EXPECT_EQ(results.newest(), 5);
}

}  // namespace
}  // namespace prospect::resumed_test
