// SPDX-License-Identifier: Apache-2.0
#include "runtime/clock_offset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace prospect::clock_offset_test {
namespace {

using ::testing::HasSubstr;

/// A source that sends at 15 Hz; its clock and the link may be changed as it runs.
struct Source {
  double now = 1000.0;   // of the runtime's clock: the capture
  double clock = 1.7e9;  // source's clock - runtime's
  double rate = 0.0;     // by which the source's clock is faster
  double delay = 0.020;  // of the next message
  static constexpr double kPeriod = 1.0 / 15.0;

  StampReading send(ClockOffset& offset) {
    now += kPeriod;
    clock += rate * kPeriod;
    return offset.add(now + clock, now + delay);
  }
  StampReading send(ClockOffset& offset, int count) {
    for (int n = 1; n < count; ++n) send(offset);
    return send(offset);
  }
};

TEST(ClockOffset, NeedsStampsAndTimeBeforeItSaysAnything) {
  ClockOffset offset;
  Source source;
  EXPECT_FALSE(offset.offset());
  // 0.5 s at 15 Hz are 7.5 periods: the ninth stamp.
  for (int n = 1; n <= 8; ++n) {
    const StampReading r = source.send(offset);
    EXPECT_EQ(r.verdict, StampVerdict::kSettling) << n;
    EXPECT_FALSE(r.time) << n;
  }
  const StampReading r = source.send(offset);
  EXPECT_EQ(r.verdict, StampVerdict::kGood);
  ASSERT_TRUE(r.time);
  // The constant part of the delay cannot be seen.
  EXPECT_NEAR(*r.time, source.now + source.delay, 1e-4);
  ASSERT_TRUE(offset.offset());
  EXPECT_NEAR(*offset.offset(), source.delay - source.clock, 1e-4);
}

TEST(ClockOffset, TheLeastDelayIsTakenOffIfItIsKnown) {
  ClockOffset offset({.least_delay = 0.020});
  Source source;
  const StampReading r = source.send(offset, 20);
  ASSERT_TRUE(r.time);
  EXPECT_NEAR(*r.time, source.now, 1e-4);
  EXPECT_NEAR(r.delay, source.delay, 1e-4);
  EXPECT_EQ(r.verdict, StampVerdict::kGood);
  EXPECT_NEAR(*offset.offset(), -source.clock, 1e-4);
}

TEST(ClockOffset, TheQuickestMessageTellsTheOffsetWhateverTheOthersTake) {
  std::mt19937 random(3);
  std::exponential_distribution<double> queueing(1.0 / 0.015);
  for (const double rate : {-5e-5, 0.0, 5e-5}) {
    ClockOffset offset;
    Source source;
    source.rate = rate;
    for (int n = 0; n < 3000; ++n) {
      source.delay = 0.005 + queueing(random);
      const StampReading r = source.send(offset);
      if (!r.time) continue;
      EXPECT_LE(*r.time, source.now + source.delay);
      // Late by the least delay; a quick message is some periods ago, in which clocks drift.
      if (n <= 300) continue;
      EXPECT_NEAR(*r.time, source.now + 0.005, 0.004) << rate << " " << n;
    }
    EXPECT_EQ(offset.jumps(), 0);
  }
}

// A clock that the network's time slews, as any daemon does (navigation2#2012), at 500 ppm.
TEST(ClockOffset, ASlewedClockIsFollowedOrMakesTimesTooOld) {
  for (const double rate : {5e-4, -5e-4}) {
    ClockOffset offset;
    Source source;
    source.send(offset, 20);
    source.rate = rate;
    for (int n = 0; n < 1500; ++n) {  // 100 s
      const StampReading r = source.send(offset);
      ASSERT_TRUE(r.time) << r.text;
      EXPECT_LE(*r.time, source.now + source.delay);
      // Beyond `drift` it is followed in one direction only.
      const double most_old = rate > 0.0 ? 1e-4 : 4e-4 * (n + 1) * Source::kPeriod + 1e-4;
      EXPECT_GE(*r.time, source.now + source.delay - most_old) << n;
    }
    EXPECT_EQ(offset.jumps(), 0);
  }
}

// The clock of a camera's computer is set (rtabmap_ros#1333: 10 s back, and odometry skipped all
// images for 10 s; ros2_control#2046: writing waited as long).
TEST(ClockOffset, AJumpIsReportedAndCostsTheTimeToSettleNotItsLength) {
  for (const double jump : {-1.7e9, -10.0, -0.3, 0.3, 10.0, 1.7e9}) {
    ClockOffset offset;
    Source source;
    ASSERT_TRUE(source.send(offset, 30).time);
    source.clock += jump;
    const StampReading first = source.send(offset);
    EXPECT_EQ(first.verdict, StampVerdict::kSuspect) << jump;
    EXPECT_FALSE(first.time);
    EXPECT_FALSE(first.text.empty());
    const StampReading second = source.send(offset);
    EXPECT_EQ(second.verdict, StampVerdict::kJumped) << jump;
    EXPECT_NEAR(second.jump, jump, 1e-3);
    EXPECT_THAT(second.text, HasSubstr(jump > 0 ? "went ahead by" : "went back by"));
    int without = 2;
    StampReading r = source.send(offset);
    for (; !r.time && without < 100; r = source.send(offset)) ++without;
    EXPECT_LE(without, 9) << jump;  // 0.6 s
    ASSERT_TRUE(r.time);
    EXPECT_NEAR(*r.time, source.now + source.delay, 1e-3) << jump;
    EXPECT_EQ(offset.jumps(), 1);
  }
}

TEST(ClockOffset, AJumpIsMeasuredByTheQuickerOfItsTwoStamps) {
  ClockOffset offset;
  Source source;
  source.send(offset, 30);
  source.clock += 10.0;
  source.send(offset);
  source.delay += 0.05;
  EXPECT_NEAR(source.send(offset).jump, 10.0, 1e-3);
}

TEST(ClockOffset, TheRuntimesOwnClockMayJumpToo) {
  ClockOffset offset;
  Source source;
  source.send(offset, 30);
  // Back, which a monotonic clock does not do; the source's goes on.
  source.now -= 5.0;
  source.clock += 5.0;
  EXPECT_EQ(source.send(offset).verdict, StampVerdict::kSuspect);
  const StampReading r = source.send(offset);
  EXPECT_EQ(r.verdict, StampVerdict::kJumped);
  EXPECT_NEAR(r.jump, 5.0, 1e-3);
  // The computer slept: its monotonic clock stood still.
  source.send(offset, 30);
  source.clock += 3600.0;
  source.send(offset);
  EXPECT_EQ(source.send(offset).verdict, StampVerdict::kJumped);
  EXPECT_EQ(offset.jumps(), 2);
}

// Single stamps that are wrong, or messages out of order, leave the estimate as it is.
TEST(ClockOffset, OneWrongStampIsRefusedAndChangesNothing) {
  struct Case {
    const char* what;
    double by;  // [s] added to the stamp
    StampVerdict verdict;
  };
  for (const Case& c : {Case{"far ahead", 1e6, StampVerdict::kSuspect},
                        Case{"a little ahead", 0.15, StampVerdict::kSuspect},
                        Case{"zero", -1.7e9 - 1000.0, StampVerdict::kSuspect},
                        Case{"out of order by far", -1.0, StampVerdict::kSuspect},
                        Case{"out of order", -0.12, StampVerdict::kDelayed},
                        Case{"no number", std::nan(""), StampVerdict::kInvalid},
                        Case{"infinite", INFINITY, StampVerdict::kInvalid}}) {
    ClockOffset offset;
    Source source;
    source.send(offset, 30);
    const double before = *offset.offset();
    source.clock += c.by;
    const StampReading wrong = source.send(offset);
    source.clock = 1.7e9;
    EXPECT_EQ(wrong.verdict, c.verdict) << c.what << ": " << wrong.text;
    EXPECT_EQ(wrong.time.has_value(), c.verdict == StampVerdict::kDelayed) << c.what;
    EXPECT_FALSE(wrong.text.empty());
    EXPECT_EQ(offset.refused(), c.verdict == StampVerdict::kDelayed ? 0 : 1) << c.what;
    const StampReading r = source.send(offset);
    EXPECT_EQ(r.verdict, StampVerdict::kGood) << c.what;
    EXPECT_NEAR(*offset.offset(), before, 1e-4) << c.what;
    EXPECT_EQ(offset.jumps(), 0) << c.what;
  }
}

TEST(ClockOffset, TwoStampsThatAreWrongInOtherWaysAreNoJump) {
  ClockOffset offset;
  Source source;
  source.send(offset, 30);
  for (const double by : {1e6, -1e6, 3e6}) {
    source.clock = 1.7e9 + by;
    EXPECT_EQ(source.send(offset).verdict, StampVerdict::kSuspect);
  }
  source.clock = 1.7e9;
  EXPECT_EQ(source.send(offset).verdict, StampVerdict::kGood);
  EXPECT_EQ(offset.jumps(), 0);
  EXPECT_EQ(offset.refused(), 3);
}

// What is late must never look fresh, however long it goes on.
TEST(ClockOffset, SlowMessagesStayOld) {
  ClockOffset offset;
  Source source;
  source.send(offset, 30);
  for (int n = 0; n < 600; ++n) {  // the link fills up: 0.8 s within 4 s, and stays so for 36 s
    source.delay = std::min(0.8, source.delay + 0.013);
    const StampReading r = source.send(offset);
    ASSERT_TRUE(r.time);
    EXPECT_LE(*r.time, source.now + 0.020 + 2e-4 + 1e-4 * n * Source::kPeriod);
    const bool late = source.delay > 0.15;
    EXPECT_TRUE(!late || r.verdict == StampVerdict::kDelayed);
  }
  EXPECT_EQ(offset.jumps(), 0);
}

// A pause that is longer than the step back hides it. Times are too old then, until a reset.
TEST(ClockOffset, AStepBackAcrossAPauseMakesTimesTooOldAndSaysSo) {
  ClockOffset offset;
  Source source;
  source.send(offset, 30);
  source.now += 10.0;
  source.clock -= 4.0;
  const StampReading r = source.send(offset);
  EXPECT_EQ(r.verdict, StampVerdict::kDelayed);
  EXPECT_NEAR(r.delay, 4.0, 2e-3);
  EXPECT_THAT(r.text, HasSubstr("set back"));
  EXPECT_EQ(source.send(offset, 100).verdict, StampVerdict::kDelayed);
  offset.reset();
  EXPECT_FALSE(source.send(offset).time);
  const StampReading after = source.send(offset, 20);
  EXPECT_EQ(after.verdict, StampVerdict::kGood);
  EXPECT_NEAR(after.delay, 0.0, 1e-3);
}

// The same image again and again gets older.
TEST(ClockOffset, AStuckSourceGetsOlder) {
  ClockOffset offset;
  Source source;
  source.send(offset, 30);
  for (int n = 1; n <= 10; ++n) {
    const StampReading r = offset.add(source.now + source.clock, source.now + 0.02 + 0.1 * n);
    EXPECT_NEAR(r.delay, 0.1 * n, 1e-3);
    EXPECT_EQ(r.verdict, n > 1 ? StampVerdict::kDelayed : StampVerdict::kGood);
  }
}

TEST(ClockOffset, StampsOfTheRuntimesOwnClockAreTakenAsTheyAre) {
  ClockOffset offset({.own_clock = false});
  EXPECT_EQ(offset.offset(), 0.0);
  const StampReading good = offset.add(12.0, 12.3);
  EXPECT_EQ(good.verdict, StampVerdict::kGood);
  EXPECT_EQ(good.time, 12.0);
  EXPECT_NEAR(good.delay, 0.3, 1e-12);
  EXPECT_EQ(offset.add(12.3005, 12.3).time, 12.3);  // two readings of one clock
  const StampReading future = offset.add(12.5, 12.3);
  EXPECT_EQ(future.verdict, StampVerdict::kFuture);
  EXPECT_FALSE(future.time);
  EXPECT_THAT(future.text, HasSubstr("0.2 s ahead"));
  EXPECT_EQ(offset.add(std::nan(""), 12.3).verdict, StampVerdict::kInvalid);
  EXPECT_EQ(offset.refused(), 2);
}

TEST(ClockOffset, RefusesOptionsOutOfRange) {
  EXPECT_THROW(ClockOffset({.drift = -1.0}), std::invalid_argument);
  EXPECT_THROW(ClockOffset({.jump = 0.0}), std::invalid_argument);
  EXPECT_THROW(ClockOffset({.settle_count = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::clock_offset_test
