// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulated_streams.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "adapters/robots/faults/faulty_frames.h"
#include "models/unicycle.h"
#include "runtime/clock.h"
#include "tests/adapters/box_room.h"

namespace prospect::simulated_streams_test {
namespace {

constexpr double kSpeed = 0.2;  // [m/s]

/// A robot without noise that drives along x from 2 m on, with a belief every 0.05 s and a scan
/// every 0.2 s; faults begin at 1 s, for 2 s.
struct Drive final : MissionObserver {
  explicit Drive(const std::string& fault, const std::string& when = "@1+2", double imu_rate = 0.0)
      : faults(fault.empty() ? std::vector<InjectedFault>{}
                             : std::vector<InjectedFault>{parse_fault(fault + when)}),
        simulator(std::make_shared<World>(test::box_room(5.0, 3.0, 2.0, 0.1)), perfect(imu_rate)),
        base(simulator, clock, model, {}),
        inbox(clock, FaultyFrames::inbox_options(simulated_inbox({}), faults)),
        frames(clock, inbox, faults, base.start(), {0.3, 4.0}),
        streams(base, simulator, clock, inbox, frames, 0.05) {
    streams.watched_by({this});
  }

  static SimulatorOptions perfect(double imu_rate) {
    SimulatorOptions options;
    options.imu.rate = imu_rate;
    options.odometry.perfect = true;
    options.depth.columns = 16;
    options.depth.rows = 12;
    return options;
  }
  void on_frame(const SensorFrame& frame) override {
    if (const auto* scan = std::get_if<ScanFrame>(&frame)) measured = scan->stamp;
  }

  /// What is known at that time; null: nothing new.
  std::shared_ptr<const Belief> until(double time) {
    std::shared_ptr<const Belief> known;
    while (step * 0.05 < time - 1e-9) {
      base.send({{kSpeed, 0.0, 0.0}, 0.0}, clock.now() + 0.1);
      ++step;
      clock.set(100.0 + 0.05 * step);
      known = streams.update({});
    }
    return known;
  }
  /// [s] of driving until where the robot is taken to be.
  static double driven(const Belief& known) { return (known.pose.position.x() - 2.5) / kSpeed; }

  ManualClock clock{100.0};
  const Unicycle model;
  const std::vector<InjectedFault> faults;
  Simulator simulator;
  SimulatedBase base;
  SensorInbox inbox;
  FaultyFrames frames;
  double measured = 0.0;  // [s], the newest scan
  SimulatedStreams streams;
  int step = 0;
};

TEST(SimulatedStreams, WithoutAFaultAllComesThroughAtOnce) {
  Drive drive("");
  const auto known = drive.until(1.5);
  ASSERT_TRUE(known);
  EXPECT_NEAR(Drive::driven(*known), 1.5, 1e-6);
  EXPECT_NEAR(known->stamps.pose, 101.5, 1e-9);
  EXPECT_NEAR(known->stamps.ranges, 101.4, 1e-9);
  EXPECT_EQ(known->stamps.map, known->stamps.ranges);
  EXPECT_EQ(known->stamp, known->stamps.pose);
  EXPECT_EQ(known->localization, Localization::kOk);
  EXPECT_NEAR(drive.measured, 101.4, 1e-9);
  ASSERT_TRUE(drive.inbox.ranges().scan.in_B) << "for who looks at raw ranges";
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
           Case{"depth:off", 0.0, 2.15, 2.95}, Case{"depth:stuck", 0.0, 0.15, 2.95},
           Case{"depth:delayed", 0.0, 0.55, 2.95},
           Case{"clock:stuck", 1.95, 1.95, 1.5},    // new pictures, until they are too old
           Case{"clock:garbage", 2.0, 2.95, 0.95},  // too few scans before to know their clock
           Case{"clock:wrong", 0.0, kAny, 2.95},    // has settled anew
       }) {
    Drive drive(c.fault);
    const auto known = drive.until(2.95);
    ASSERT_TRUE(known) << c.fault;
    EXPECT_NEAR(102.95 - known->stamps.pose, c.pose_age, 0.011) << c.fault;
    EXPECT_NEAR(Drive::driven(*known), c.x, 0.011) << c.fault;
    if (c.ranges_age != kAny) {
      EXPECT_NEAR(102.95 - known->stamps.ranges, c.ranges_age, 0.011) << c.fault;
    }
    // Once it is over, all is well again.
    const auto after = drive.until(4.5);
    EXPECT_NEAR(after->stamps.pose, 104.5, 0.011) << c.fault;
    EXPECT_NEAR(Drive::driven(*after), 4.5, 0.011) << c.fault;
  }
}

// Nothing but what came through is in the map.
TEST(SimulatedStreams, AMapIsMadeOfTheFramesThatCome) {
  const auto map_changes = [](const char* fault) {
    Drive drive(fault);
    const auto before = drive.until(1.0)->ground;
    return drive.until(2.9)->ground != before;
  };
  EXPECT_TRUE(map_changes("cameras:off"));
  EXPECT_FALSE(map_changes("depth:off"));
  EXPECT_TRUE(map_changes("depth:garbage"));
}

TEST(SimulatedStreams, AClockThatJumpsIsCounted) {
  Drive drive("clock:wrong");
  drive.until(0.9);
  EXPECT_EQ(drive.inbox.count(SensorStream::kLeft).jumps, 0);
  drive.until(1.2);
  EXPECT_EQ(drive.inbox.count(SensorStream::kLeft).jumps, 1);
  drive.until(3.5);
  EXPECT_EQ(drive.inbox.count(SensorStream::kLeft).jumps, 2);
}

TEST(SimulatedStreams, AnImuComesThroughItsOwnFaults) {
  const auto came = [](const char* fault, double until) {
    Drive drive(fault, "@1+2", 100.0);
    drive.until(until);
    return drive.inbox.imu_since(until < 2.0 ? 0.0 : 102.0);
  };
  const auto well = came("", 1.5);
  ASSERT_EQ(well.size(), 150u);
  EXPECT_NEAR(well.back().stamp, 101.5, 1e-9);
  EXPECT_NEAR(well.back().yaw_rate(), 0.0, 0.1);
  EXPECT_NEAR(well.back().linear_acceleration.z(), 9.81, 1.0);
  EXPECT_TRUE(came("imu:off", 2.9).empty());
  EXPECT_TRUE(came("imu:garbage", 2.9).empty());
  EXPECT_GE(came("cameras:off", 2.9).size(), 89u) << "the last may be due an instant later";
  const auto wrong = came("imu:wrong", 2.9);
  ASSERT_GE(wrong.size(), 89u);
  EXPECT_NEAR(wrong.back().yaw_rate(), kGyroOff, 0.1);
  const auto stuck = came("imu:stuck", 2.9);
  ASSERT_GT(stuck.size(), 80u);
  EXPECT_EQ(stuck.front().angular_velocity, stuck.back().angular_velocity);
  EXPECT_GT(stuck.back().stamp, 102.85);
  const auto late = came("imu:delayed", 2.9);
  ASSERT_FALSE(late.empty());
  EXPECT_NEAR(late.back().stamp, 102.6, 0.051);
  EXPECT_LE(came("imu:slow", 2.9).size(), 2u);
  EXPECT_LT(came("imu:intermittent", 2.95).size(), 100u);
}

TEST(SimulatedStreams, FromWhatNeverCameNothingIsKnown) {
  Drive blind("left-camera:off", "");
  EXPECT_FALSE(blind.until(1.0));
  Drive without_depth("depth:off", "");
  const auto known = without_depth.until(1.0);
  ASSERT_TRUE(known);
  EXPECT_NEAR(known->stamps.pose, 101.0, 1e-9);
  EXPECT_EQ(known->stamps.ranges, 100.0);
  EXPECT_EQ(known->stamps.map, 100.0);
}

}  // namespace
}  // namespace prospect::simulated_streams_test
