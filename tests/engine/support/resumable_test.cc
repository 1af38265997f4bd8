// SPDX-License-Identifier: Apache-2.0
#include "engine/support/resumable.h"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <vector>

namespace prospect::resumable_test {
namespace {

using Clock = Resumable::Clock;
constexpr auto kPast = Clock::time_point::min();
constexpr auto kNever = Clock::time_point::max();

TEST(Resumable, GoesOnWhereItPausedAndEndsOnce) {
  Resumable work;
  EXPECT_FALSE(work.busy());
  EXPECT_TRUE(work.run_until(kPast)) << "nothing was begun";
  for (int round = 0; round < 3; ++round) {
    std::vector<int> made;
    work.begin([&](const PausePoint& pause) {
      for (int k = 0; k < 5; ++k) {
        made.push_back(k);
        pause();
      }
    });
    EXPECT_TRUE(work.busy());
    EXPECT_TRUE(made.empty()) << "nothing is done before it is run";
    int pieces = 0;
    while (!work.run_until(kPast)) EXPECT_EQ(made.size(), static_cast<std::size_t>(++pieces));
    EXPECT_EQ(pieces, 5);
    EXPECT_EQ(made, (std::vector<int>{0, 1, 2, 3, 4}));
    EXPECT_FALSE(work.busy());
  }
  int sum = 0;
  work.begin([&](const PausePoint& pause) {
    for (int k = 0; k < 1000; ++k, pause()) sum += k;
  });
  EXPECT_TRUE(work.run_until(kNever)) << "with time enough it does not pause";
  EXPECT_EQ(sum, 499500);
}

TEST(Resumable, WhatItThrowsEndsIt) {
  Resumable work;
  work.begin([](const PausePoint& pause) {
    pause();
    throw std::runtime_error("broken");
  });
  EXPECT_FALSE(work.run_until(kPast));
  EXPECT_THROW(work.run_until(kNever), std::runtime_error);
  EXPECT_FALSE(work.busy());
  EXPECT_TRUE(work.run_until(kNever));
}

TEST(Resumable, WhatIsGivenUpIsUnwound) {
  const auto held = std::make_shared<int>(0);
  int ended = 0;
  const auto endless = [held, &ended](const PausePoint& pause) {
    struct End {
      int& count;
      ~End() { ++count; }
    } end{ended};
    while (true) pause();
  };
  Resumable work;
  work.begin(endless);
  work.give_up();  // before any of it was done
  EXPECT_FALSE(work.busy());
  work.begin(endless);
  EXPECT_FALSE(work.run_until(kPast));
  work.give_up();
  EXPECT_EQ(held.use_count(), 2) << "of the work nothing is kept";
  {
    Resumable other;
    other.begin(endless);
    EXPECT_FALSE(other.run_until(kPast));
  }
  EXPECT_EQ(ended, 3);
  work.begin([](const PausePoint&) {});
  EXPECT_TRUE(work.run_until(kPast)) << "it can be begun anew";
}

}  // namespace
}  // namespace prospect::resumable_test
