#include "engine/problem/stop_condition.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <thread>
#include <vector>

namespace prospect::stop_condition_test {
namespace {

TEST(StopCondition, TheDefaultNeverStops) { EXPECT_EQ(StopCondition()(), StopRequest::kNone); }

TEST(StopCondition, ADeadlineStrikesWhenItsTimeHasPassedAndNotBefore) {
  const auto before = StopCondition::Clock::now();
  const StopCondition stop = deadline(0.05);
  const auto after = StopCondition::Clock::now();
  StopCondition::Clock::time_point asked;
  do {
    asked = StopCondition::Clock::now();
    if (stop() != StopRequest::kNone) break;
    ASSERT_LT(asked - after, std::chrono::milliseconds(50));
  } while (true);
  EXPECT_EQ(stop(), StopRequest::kDeadline);
  EXPECT_GE(StopCondition::Clock::now() - before, std::chrono::milliseconds(50));
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
  using Time = StopCondition::Clock::time_point;
  const Time before = StopCondition::Clock::now();
  const StopCondition soon = deadline(10.0), late = deadline(20.0);
  const Time after = StopCondition::Clock::now();
  EXPECT_GE(soon.latest(), before + std::chrono::seconds(10));
  EXPECT_LE(soon.latest(), after + std::chrono::seconds(10));
  const StopCondition cancel = cancelled_by([] { return false; });
  EXPECT_EQ(cancel.latest(), Time::max());
  EXPECT_EQ(StopCondition().latest(), Time::max());
  EXPECT_EQ(deadline(1e10).latest(), Time::max());
  EXPECT_EQ((late || soon).latest(), soon.latest());
  EXPECT_EQ((soon || late).latest(), soon.latest());
  EXPECT_EQ((cancel || soon).latest(), soon.latest());
  const StopCondition over = deadline(0.0);
  EXPECT_LE(over.latest(), StopCondition::Clock::now());
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
  const auto latest = StopCondition::Clock::now();
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
