#include "adapters/simulator/simulated_streams.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "runtime/clock.h"

namespace prospect::simulated_streams_test {
namespace {

/// Beliefs every 0.05 s, at x = their time, with a scan every 0.2 s; faults begin at 1 s, for 2 s.
struct Drive {
  explicit Drive(const std::string& fault)
      : streams(clock,
                fault.empty() ? std::vector<InjectedFault>{}
                              : std::vector<InjectedFault>{parse_fault(fault + "@1+2")},
                100.0) {}

  /// What is known at that time; x is counted from the start, as are the stamps.
  Belief until(double time) {
    Belief known;
    while (step * 0.05 < time - 1e-9) {
      ++step;
      clock.set(100.0 + 0.05 * step);
      Belief made;
      made.localization = Localization::kOk;
      made.stamp = clock.now();
      made.pose.position.x() = 0.05 * step;
      const double scan = 100.0 + 0.2 * (step / 4);
      made.stamps = {made.stamp, scan, made.stamp, scan};
      if (const auto come = streams.through(made)) known = *come;
    }
    return known;
  }

  ManualClock clock{100.0};
  SimulatedStreams streams;
  int step = 0;
};

TEST(SimulatedStreams, WithoutAFaultAllComesThroughAtOnce) {
  Drive drive("");
  const Belief known = drive.until(1.5);
  EXPECT_NEAR(known.pose.position.x(), 1.5, 1e-9);
  EXPECT_NEAR(known.stamps.pose, 101.5, 1e-9);
  EXPECT_NEAR(known.stamps.ranges, 101.4, 1e-9);
  EXPECT_EQ(known.stamp, known.stamps.pose);
  EXPECT_EQ(known.localization, Localization::kOk);
}

// Of each fault, how old pose and ranges are at 2.95 s, and where the robot is taken to be.
TEST(SimulatedStreams, TableOfFaults) {
  struct Case {
    const char* fault;
    double pose_age, ranges_age, x;
  };
  constexpr double kAny = -1.0;
  for (const Case& c : {
           Case{"left-camera:off", 2.0, 0.15, 0.95}, Case{"left-camera:stuck", 2.0, 0.15, 0.95},
           Case{"right-camera:garbage", 2.0, 0.15, 0.95},
           Case{"right-camera:wrong", 2.0, 0.15, 0.95},
           Case{"left-camera:delayed", 0.3, 0.15, 2.65}, Case{"cameras:delayed", 0.3, 0.15, 2.65},
           Case{"cameras:off", 2.0, 0.15, 0.95},
           Case{"cameras:stuck", 0.0, 0.15, 0.95},  // new stamps, the old picture
           Case{"cameras:garbage", 2.0, 0.15, 0.95}, Case{"cameras:intermittent", 0.0, 0.15, 2.95},
           Case{"depth:off", 0.0, 2.15, 2.95}, Case{"depth:stuck", 0.0, 0.0, 2.95},
           Case{"depth:delayed", 0.0, 0.35, 2.95},
           Case{"clock:stuck", 1.95, 2.15, 1.5},  // new pictures, until they are too old
           Case{"clock:garbage", 2.0, 2.15, 0.95},
           Case{"clock:wrong", 0.0, kAny, 2.95},  // has settled anew
       }) {
    Drive drive(c.fault);
    const Belief known = drive.until(2.95);
    EXPECT_NEAR(102.95 - known.stamps.pose, c.pose_age, 0.011) << c.fault;
    EXPECT_NEAR(known.pose.position.x(), c.x, 0.011) << c.fault;
    if (c.ranges_age != kAny) {
      EXPECT_NEAR(102.95 - known.stamps.ranges, c.ranges_age, 0.21) << c.fault;
    }
    // Once it is over, all is well again.
    const Belief after = drive.until(4.5);
    EXPECT_NEAR(after.stamps.pose, 104.5, 0.011) << c.fault;
    EXPECT_NEAR(after.pose.position.x(), 4.5, 0.011) << c.fault;
  }
}

TEST(SimulatedStreams, AClockThatJumpsIsCounted) {
  Drive drive("clock:wrong");
  drive.until(0.9);
  EXPECT_EQ(drive.streams.inbox().count(SensorStream::kLeft).jumps, 0);
  drive.until(1.2);
  EXPECT_EQ(drive.streams.inbox().count(SensorStream::kLeft).jumps, 1);
  drive.until(3.5);
  EXPECT_EQ(drive.streams.inbox().count(SensorStream::kLeft).jumps, 2);
}

TEST(SimulatedStreams, FromWhatNeverCameNothingIsKnown) {
  ManualClock clock(100.0);
  SimulatedStreams blind(clock, {parse_fault("left-camera:off")}, 100.0);
  SimulatedStreams without_depth(clock, {parse_fault("depth:off")}, 100.0);
  clock.set(101.0);
  Belief made;
  made.set_stamps(101.0);
  EXPECT_FALSE(blind.through(made));
  const std::optional<Belief> known = without_depth.through(made);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->stamps.pose, 101.0);
  EXPECT_EQ(known->stamps.ranges, 100.0);
  EXPECT_EQ(known->stamps.map, 100.0);
}

}  // namespace
}  // namespace prospect::simulated_streams_test
