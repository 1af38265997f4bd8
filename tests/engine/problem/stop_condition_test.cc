// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/stop_condition.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <thread>
#include <vector>

namespace prospect::stop_condition_test {
namespace {

TEST(StopCondition, TheDefaultNeverStops) { EXPECT_EQ(StopCondition()(), StopRequest::kNone); }

TEST(StopCondition, ADeadlineStrikesWhenItsTimeHasPassedAndNotBefore) {
  for (const SolveClock clock : {SolveClock::kWall, SolveClock::kProcessor}) {
    const double before = seconds_by(clock);
    const StopCondition stop = deadline(0.05, clock);
    const double after = seconds_by(clock);
    EXPECT_EQ(stop.clock(), clock);
    do {
      const double asked = seconds_by(clock);
      if (stop() != StopRequest::kNone) break;
      ASSERT_LT(asked - after, 0.05);
    } while (true);
    EXPECT_EQ(stop(), StopRequest::kDeadline);
    EXPECT_GE(seconds_by(clock) - before, 0.05 - 1e-9);
  }
}

TEST(StopCondition, ProcessorTimeDoesNotPassWhileOthersWork) {
  const double before = seconds_by(SolveClock::kProcessor);
  const StopCondition stop = deadline(0.03, SolveClock::kProcessor);
  // Of this process nothing works meanwhile.
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  const double passed = seconds_by(SolveClock::kProcessor) - before;
  EXPECT_LT(passed, 0.03);
  EXPECT_EQ(stop(), StopRequest::kNone);
}

TEST(StopCondition, OddDeadlines) {
  EXPECT_EQ(deadline(0.0)(), StopRequest::kDeadline);
  EXPECT_EQ(deadline(-1.0)(), StopRequest::kDeadline);
  EXPECT_EQ(deadline(-1e300)(), StopRequest::kDeadline);
  EXPECT_EQ(deadline(std::numeric_limits<double>::quiet_NaN())(), StopRequest::kDeadline);
  EXPECT_EQ(deadline(std::numeric_limits<double>::infinity())(), StopRequest::kNone);
  // Longer than the clock can count.
  for (const double seconds : {1e8, 1e9, 1e10, 1e100}) {
    EXPECT_EQ(deadline(seconds)(), StopRequest::kNone) << seconds;
  }
}

TEST(StopCondition, SaysWhenItStopsAtTheLatest) {
  const double before = seconds_by(SolveClock::kWall);
  const StopCondition soon = deadline(10.0), late = deadline(20.0);
  const double after = seconds_by(SolveClock::kWall);
  EXPECT_GE(soon.latest(), before + 10.0);
  EXPECT_LE(soon.latest(), after + 10.0);
  EXPECT_LE(soon.left(), 10.0);
  const StopCondition cancel = cancelled_by([] { return false; });
  EXPECT_EQ(cancel.left(), StopCondition::kNever);
  EXPECT_EQ(StopCondition().left(), StopCondition::kNever);
  EXPECT_EQ(deadline(1e10).left(), StopCondition::kNever);
  EXPECT_EQ((late || soon).latest(), soon.latest());
  EXPECT_EQ((soon || late).latest(), soon.latest());
  EXPECT_EQ((cancel || soon).latest(), soon.latest());
  EXPECT_LE(deadline(0.0).left(), 0.0);
  // Of two clocks that of what strikes first.
  const StopCondition worked = deadline(1.0, SolveClock::kProcessor);
  EXPECT_EQ((soon || worked).clock(), SolveClock::kProcessor);
  EXPECT_EQ((worked || cancel).clock(), SolveClock::kProcessor);
  EXPECT_EQ((worked || deadline(0.1)).clock(), SolveClock::kWall);
}

TEST(StopCondition, CancellationIsSeenFromAnotherThread) {
  std::atomic<bool> flag{false};
  const StopCondition stop = cancelled_by([&] { return flag.load(); });
  EXPECT_EQ(stop(), StopRequest::kNone);
  std::thread([&] { flag = true; }).join();
  EXPECT_EQ(stop(), StopRequest::kCancelled);
  EXPECT_EQ(cancelled_by({})(), StopRequest::kNone);
}

TEST(StopCondition, EitherOfTwoStops) {
  bool flag = false;
  const StopCondition cancel = cancelled_by([&] { return flag; });
  EXPECT_EQ((cancel || StopCondition())(), StopRequest::kNone);
  EXPECT_EQ((StopCondition() || cancel)(), StopRequest::kNone);
  EXPECT_EQ((cancel || deadline(0.0))(), StopRequest::kDeadline);
  EXPECT_EQ((deadline(0.0) || cancel)(), StopRequest::kDeadline);
  flag = true;
  EXPECT_EQ((cancel || deadline(0.0))(), StopRequest::kCancelled);  // the first that answers
  EXPECT_EQ((StopCondition() || cancel)(), StopRequest::kCancelled);
  EXPECT_EQ((cancel || StopCondition())(), StopRequest::kCancelled);
  EXPECT_EQ((StopCondition() || StopCondition())(), StopRequest::kNone);
}

TEST(StopCondition, OneAtATimeOnManyThreads) {
  std::atomic<int> asking = 0;
  int asked = 0;  // not atomic: that is what it is for
  bool together = false;
  const double latest = seconds_by(SolveClock::kWall);
  // It changes its mind after the thousandth time.
  const StopCondition stop(
      [&] {
        if (++asking > 1) together = true;
        ++asked;
        --asking;
        return asked == 1000 ? StopRequest::kCancelled : StopRequest::kNone;
      },
      latest);
  const StopCondition one = one_at_a_time(stop);
  EXPECT_EQ(one.latest(), latest);
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&] {
      while (one() == StopRequest::kNone) {
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_FALSE(together);
  EXPECT_EQ(asked, 1000);
  EXPECT_EQ(one(), StopRequest::kCancelled);
  EXPECT_EQ(asked, 1000);
}

}  // namespace
}  // namespace prospect::stop_condition_test
