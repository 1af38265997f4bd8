// SPDX-License-Identifier: Apache-2.0
#include "runtime/sensor_inbox.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "models/robot_description.h"

namespace prospect::sensor_inbox_test {
namespace {

constexpr double kNow = 100.0;

SensorInboxOptions in_one_clock() {
  SensorInboxOptions options;
  options.cameras_in_runtime_clock = options.wheels_in_runtime_clock = true;
  options.depth_in_runtime_clock = options.scan_in_runtime_clock = true;
  options.poses_in_runtime_clock = options.imu_in_runtime_clock = true;
  return options;
}

Image image(std::uint8_t grey = 0) { return Image(2, 2, grey); }

WheelSample sample(double stamp) {
  WheelSample s;
  s.stamp = stamp;
  return s;
}

struct Inbox {
  explicit Inbox(const SensorInboxOptions& options = in_one_clock()) : box(clock, options) {}
  std::vector<double> taken_stamps() {
    std::vector<double> stamps;
    while (const auto frame = box.take()) stamps.push_back(stamp_of(*frame));
    return stamps;
  }
  ManualClock clock{kNow};
  SensorInbox box;
};

TEST(SensorInbox, GivesTheOldestStampFirstWhateverCameFirst) {
  Inbox in;
  in.box.depth(99.93, DepthImage(1, 1, 1.0f));
  in.box.wheels(sample(99.95));
  in.box.scan(99.91, {});
  in.box.pair(99.92, 99.92, {image(), image()});
  in.box.observe(ExternalPose{.stamp = 99.94});
  in.box.wheels(sample(99.90));
  EXPECT_EQ(in.taken_stamps(), (std::vector<double>{99.90, 99.91, 99.92, 99.93, 99.94, 99.95}));
  EXPECT_FALSE(in.box.take());
}

TEST(SensorInbox, SamplesOfAnImuAreKeptForWhoWatchesTheBaseAndWakeNobody) {
  SensorInboxOptions options = in_one_clock();
  options.wheel_capacity = 3;
  Inbox in(options);
  const auto imu = [&](double stamp, double rate) {
    ImuSample s;
    s.stamp = stamp;
    s.angular_velocity.z() = rate;
    in.box.observe(s);
  };
  for (const double stamp : {99.90, 99.92, 99.91, 99.94, 99.96}) imu(stamp, stamp);
  imu(99.97, std::nan(""));
  imu(std::nan(""), 1.0);
  EXPECT_FALSE(in.box.wait(0.0, {})) << "nothing to perceive";
  const std::vector<ImuSample> since = in.box.imu_since(99.92);
  ASSERT_EQ(since.size(), 2u);
  EXPECT_EQ(since[0].stamp, 99.94);
  EXPECT_EQ(since[1].angular_velocity.z(), 99.96);
  EXPECT_EQ(in.box.imu_since(0.0).size(), 3u);
  EXPECT_TRUE(in.box.imu_since(99.96).empty());
  const StreamCount count = in.box.count(SensorStream::kImu);
  EXPECT_EQ(count.received, 7u);
  EXPECT_EQ(count.refused, 2u);
  EXPECT_EQ(*count.newest, 99.96) << "what is no measurement keeps it from being stale for nobody";
  in.box.wheels(sample(99.93));
  EXPECT_TRUE(in.box.wait(0.0, {}));
  EXPECT_EQ(in.taken_stamps(), (std::vector<double>{99.92, 99.93, 99.94, 99.96}));
  EXPECT_EQ(in.box.imu_since(0.0).size(), 3u) << "also after they were taken";
}

TEST(SensorInbox, PairsByStampAndNotBySequence) {
  Inbox in;
  // The left image of 99.80 is lost, and the right ones come late.
  in.box.left(99.90, image(1));
  in.box.left(99.95, image(2));
  in.box.right(99.802, image(10));
  in.box.right(99.903, image(11));
  in.box.right(99.947, image(12));
  std::vector<std::pair<int, int>> pairs;
  while (const auto frame = in.box.take()) {
    const auto& pair = std::get<StereoFrame>(*frame);
    pairs.emplace_back(pair.left->pixels[0], pair.right->pixels[0]);
  }
  EXPECT_EQ(pairs, (std::vector<std::pair<int, int>>{{1, 11}, {2, 12}}));
  EXPECT_EQ(in.box.count(SensorStream::kRight).unpaired, 1u);
  EXPECT_EQ(in.box.count(SensorStream::kRight).taken, 2u);
  EXPECT_EQ(in.box.count(SensorStream::kLeft).unpaired, 0u);
  EXPECT_EQ(in.box.count(SensorStream::kPair).received, 2u);
}

TEST(SensorInbox, TheNearestPartnerIsTaken) {
  Inbox in;
  in.box.right(99.900, image(1));
  in.box.right(99.904, image(2));
  in.box.left(99.9035, image(3));
  const auto frame = in.box.take();
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<StereoFrame>(*frame).right->pixels[0], 2);
  EXPECT_DOUBLE_EQ(std::get<StereoFrame>(*frame).right_stamp, 99.904);
}

TEST(SensorInbox, BeyondTheToleranceThereIsNoPair) {
  Inbox in;
  in.box.left(99.90, image());
  in.box.right(99.9051, image());
  EXPECT_FALSE(in.box.take());
  EXPECT_EQ(in.box.count(SensorStream::kPair).received, 0u);
}

TEST(SensorInbox, IsBoundedAndDropsTheOldest) {
  SensorInboxOptions options = in_one_clock();
  options.capacity = 2;
  Inbox in(options);
  for (const double stamp : {99.7, 99.8, 99.9}) in.box.depth(stamp, DepthImage(1, 1, 1.0f));
  for (const double stamp : {99.7, 99.8, 99.9}) in.box.left(stamp, image());
  EXPECT_EQ(in.taken_stamps(), (std::vector<double>{99.8, 99.9}));
  const StreamCount depth = in.box.count(SensorStream::kDepth);
  EXPECT_EQ(depth.received, 3u);
  EXPECT_EQ(depth.overflown, 1u);
  EXPECT_EQ(depth.taken, 2u);
  EXPECT_EQ(depth.reason, "more came than were taken");
  EXPECT_EQ(in.box.count(SensorStream::kLeft).unpaired, 1u);
}

TEST(SensorInbox, WhatIsTooOldIsDroppedWhenItWouldBeTaken) {
  Inbox in;
  in.box.pair(99.9, 99.9, {image(), image()});
  in.box.pair(100.0, 100.0, {image(), image()});
  in.clock.set(100.45);
  EXPECT_EQ(in.taken_stamps(), (std::vector<double>{100.0}));
  EXPECT_EQ(in.box.count(SensorStream::kPair).too_old, 1u);
  EXPECT_EQ(in.box.count(SensorStream::kPair).reason, "it was 0.55 s old");
}

TEST(SensorInbox, NoWayThatWheelsTellOfIsLostByAPause) {
  Inbox in;
  std::vector<double> stamps;
  for (int k = 0; k < 100; ++k) {
    stamps.push_back(98.0 + 0.02 * k);
    in.box.wheels(sample(stamps.back()));
  }
  in.clock.set(102.0);
  EXPECT_EQ(in.taken_stamps(), stamps);
  EXPECT_EQ(in.box.count(SensorStream::kWheels).too_old, 0u);
}

TEST(SensorInbox, SaysWhichStreamIsStale) {
  Inbox in;
  EXPECT_EQ(in.box.stale(), "");
  in.box.depth(99.9, DepthImage(1, 1, 1.0f));
  EXPECT_EQ(in.box.stale(), "");
  in.clock.set(101.0);
  EXPECT_EQ(in.box.stale(), "depth: the newest frame is 1.1 s old; at most 1 s");
}

TEST(SensorInbox, WhatCannotBeUsedIsRefusedAndCounted) {
  Inbox in;
  in.box.wheels(sample(std::nan("")));
  in.box.wheels(sample(std::numeric_limits<double>::infinity()));
  in.box.wheels(sample(kNow + 1.0));
  in.box.left(99.9, Image());
  in.box.depth(99.9, DepthImage());
  in.box.observe(ScanFrame{99.9, nullptr, nullptr});
  EXPECT_EQ(in.box.count(SensorStream::kScan).refused, 1u);
  in.box.pair(99.9, 99.9, {image(), Image()});
  in.box.pair(99.9, std::nan(""), {image(), image()});
  EXPECT_FALSE(in.box.take());
  EXPECT_EQ(in.box.count(SensorStream::kWheels).refused, 3u);
  EXPECT_EQ(in.box.count(SensorStream::kWheels).reason,
            "its stamp is future: 1 s ahead of the runtime's clock");
  EXPECT_EQ(in.box.count(SensorStream::kLeft).refused, 1u);
  EXPECT_EQ(in.box.count(SensorStream::kDepth).refused, 1u);
  EXPECT_EQ(in.box.count(SensorStream::kPair).refused, 2u);
}

TEST(SensorInbox, AClockOfItsOwnIsShiftedIntoTheRuntimes) {
  SensorInboxOptions options = in_one_clock();
  options.wheels_in_runtime_clock = false;
  Inbox in(options);
  // 1000 s ahead, 10 ms under way.
  for (int k = 0; k < 100; ++k) {
    in.clock.set(kNow + 0.02 * k);
    in.box.wheels(sample(kNow + 1000.0 + 0.02 * k - 0.01));
  }
  const StreamCount count = in.box.count(SensorStream::kWheels);
  ASSERT_TRUE(count.newest);
  EXPECT_NEAR(*count.newest, in.clock.now(), 1e-3);
  EXPECT_GT(count.refused, 0u);  // until the offset had settled
  EXPECT_LT(count.refused, 40u);
  // A jump of its clock costs some samples, and is counted.
  for (int k = 100; k < 200; ++k) {
    in.clock.set(kNow + 0.02 * k);
    in.box.wheels(sample(5.0 + 0.02 * k));
  }
  EXPECT_EQ(in.box.count(SensorStream::kWheels).jumps, 1);
  EXPECT_NEAR(*in.box.count(SensorStream::kWheels).newest, in.clock.now(), 1e-3);
}

TEST(SensorInbox, AClockThatRunsSlowerIsFollowedAsFarAsItMay) {
  // For 20 s, as of a simulation that makes 0.96 s of each second.
  const auto oldest_at_the_end = [](double drift) {
    SensorInboxOptions options;
    options.clock_drift = drift;
    Inbox in(options);
    for (int k = 0; k < 300; ++k) {
      in.clock.advance(1.0 / 15.0);
      in.box.wheels(sample(0.96 * (in.clock.now() - kNow)));
    }
    return in.clock.now() - in.box.count(SensorStream::kWheels).newest.value_or(0.0);
  };
  EXPECT_LT(oldest_at_the_end(0.1), 0.01);
  EXPECT_GT(oldest_at_the_end(1e-4), 0.7);
}

TEST(SensorInbox, ImagesArePairedByTheStampsOfTheirOwnClock) {
  SensorInboxOptions options = in_one_clock();
  options.cameras_in_runtime_clock = false;
  Inbox in(options);
  for (int k = 0; k < 40; ++k) {
    in.clock.set(kNow + 0.05 * k);
    in.box.left(7.0 + 0.05 * k, image());
    // The right images take longer, now and then.
    in.clock.advance(k % 3 == 0 ? 0.03 : 0.005);
    in.box.right(7.001 + 0.05 * k, image());
    while (const auto frame = in.box.take()) {
      const auto& pair = std::get<StereoFrame>(*frame);
      EXPECT_NEAR(pair.right_stamp - pair.left_stamp, 0.001, 1e-9);
    }
  }
  EXPECT_GT(in.box.count(SensorStream::kPair).taken, 20u);
  EXPECT_LE(in.box.count(SensorStream::kLeft).unpaired, 2u);
}

// Whatever the stream: until its clock is known nothing comes out, and then in the runtime's clock.
TEST(SensorInbox, EachStreamMayHaveAClockOfItsOwn) {
  SensorInboxOptions options;
  Inbox in(options);
  const double ahead = 1000.0;
  int taken = 0;
  for (int k = 0; k < 40; ++k) {
    in.clock.set(kNow + 0.05 * k);
    const double stamp = in.clock.now() + ahead;
    in.box.pair(stamp, stamp + 0.002, {image(), image()});
    in.box.depth(stamp, DepthImage(1, 1, 1.0f));
    in.box.scan(stamp, {});
    EXPECT_NEAR(in.box.pair_offset().value_or(0.002), 0.002, 1e-9);
    while (const auto frame = in.box.take()) {
      ++taken;
      EXPECT_NEAR(stamp_of(*frame), in.clock.now(), 1e-3);
      if (const auto* pair = std::get_if<StereoFrame>(&*frame)) {
        EXPECT_NEAR(pair->right_stamp - pair->left_stamp, 0.002, 1e-9);
      }
    }
    EXPECT_EQ(taken > 0, k >= 10) << k;  // settled after 0.5 s
  }
  EXPECT_EQ(taken, 3 * 30);
}

TEST(SensorInbox, ImagesThatCameAloneTellHowFarTheyAreApart) {
  Inbox in;
  in.box.left(99.95, image());
  in.box.right(99.953, image());
  EXPECT_NEAR(in.box.pair_offset().value(), 0.003, 1e-9);
  in.box.left(99.90, image());
  in.box.right(99.90, image());
  EXPECT_EQ(in.box.count(SensorStream::kPair).newest, 99.95) << "not the one that came last";
}

TEST(SensorInbox, TheNewestRangesAreThereAlsoAfterTheyWereTaken) {
  Inbox in;
  EXPECT_FALSE(in.box.ranges().depth.image);
  in.box.depth(99.9, DepthImage(1, 1, 2.0f));
  in.box.depth(99.8, DepthImage(1, 1, 1.0f));
  while (in.box.take()) {
  }
  const NewestRanges ranges = in.box.ranges();
  ASSERT_TRUE(ranges.depth.image);
  EXPECT_EQ(ranges.depth.stamp, 99.9);
  EXPECT_EQ(ranges.depth.image->at(0, 0), 2.0f);
  EXPECT_FALSE(ranges.scan.in_B);
}

// Two lidars of one stamp, and one that dies while the other goes on.
TEST(SensorInbox, EachDepthSensorIsASourceOfItsOwn) {
  Inbox in;
  const auto scan = [&](double stamp, int sensor) {
    in.box.observe(ScanFrame{stamp, std::make_shared<const DepthScan>(), nullptr, sensor});
  };
  scan(99.9, 0), scan(99.9, 1);
  in.box.observe(DepthFrame{99.8, std::make_shared<const DepthImage>(1, 1, 2.0f), 2});
  EXPECT_EQ(in.taken_stamps(), (std::vector<double>{99.8, 99.9, 99.9}));
  EXPECT_EQ(in.box.count(SensorStream::kScan).taken, 1u);
  EXPECT_EQ(in.box.count_of_sensor(1).taken, 1u);
  EXPECT_EQ(in.box.count_of_sensor(2).newest, 99.8);
  EXPECT_TRUE(in.box.ranges(1).scan.in_B);
  EXPECT_FALSE(in.box.ranges(1).depth.image);
  EXPECT_EQ(in.box.ranges(2).depth.image->at(0, 0), 2.0f);
  EXPECT_EQ(in.box.stale(), "");
  in.clock.set(kNow + 2.0);
  scan(kNow + 2.0, 0), scan(kNow + 2.0, 2);
  EXPECT_EQ(in.box.stale(), "depth sensor 1: the newest frame is 2.1 s old; at most 1 s");
  // A clock of its own, each.
  Inbox own{SensorInboxOptions()};
  for (int k = 0; k < 200; ++k) {
    const double now = kNow + 0.05 * k;
    own.clock.set(now);
    own.box.observe(ScanFrame{now - 3.0, std::make_shared<const DepthScan>(), nullptr, 0});
    own.box.observe(ScanFrame{now + 7.0, std::make_shared<const DepthScan>(), nullptr, 1});
  }
  EXPECT_NEAR(own.box.count(SensorStream::kScan).offset.value(), 3.0, 0.01);
  EXPECT_NEAR(own.box.count_of_sensor(1).offset.value(), -7.0, 0.01);
  for (const int none : {-1, kMostDepthSensors}) {
    scan(kNow + 2.1, none);
    EXPECT_EQ(in.box.count(SensorStream::kScan).reason,
              "it is of sensor " + std::to_string(none) + "; expected 0 to 15");
  }
  scan(std::nan(""), 1);
  in.box.observe(ScanFrame{kNow + 2.0, nullptr, nullptr, 1});
  EXPECT_EQ(in.box.count_of_sensor(1).refused, 2u);
}

TEST(SensorInbox, OptionsOutOfRangeAreRefused) {
  const ManualClock clock;
  SensorInboxOptions options;
  options.capacity = 0;
  EXPECT_THROW(SensorInbox(clock, options), std::invalid_argument);
  options = {};
  options.max_image_age = -1.0;
  EXPECT_THROW(SensorInbox(clock, options), std::invalid_argument);
}

TEST(SensorInbox, SeveralThreadsPutInAndOneTakes) {
  const SteadyClock clock;
  SensorInboxOptions options = in_one_clock();
  options.capacity = options.wheel_capacity = 1000;
  SensorInbox box(clock, options);
  constexpr std::size_t kEach = 200;
  std::size_t wheels = 0, pairs = 0;
  {
    const double start = clock.now();
    std::jthread wheel_source([&] {
      for (std::size_t k = 0; k < kEach; ++k) box.wheels(sample(start + 1e-6 * double(k)));
    });
    std::jthread left([&] {
      for (std::size_t k = 0; k < kEach; ++k) box.left(start + 5e-5 * double(k), image());
    });
    std::jthread right([&] {
      for (std::size_t k = 0; k < kEach; ++k) box.right(start + 5e-5 * double(k), image());
    });
    while (wheels < kEach && box.wait(10.0, {})) {
      while (const auto frame = box.take()) {
        (std::holds_alternative<WheelSample>(*frame) ? wheels : pairs) += 1;
      }
    }
  }
  while (box.take()) ++pairs;
  EXPECT_EQ(wheels, kEach);
  const StreamCount left = box.count(SensorStream::kLeft);
  const StreamCount pair = box.count(SensorStream::kPair);
  EXPECT_EQ(pair.taken, pairs);
  EXPECT_EQ(left.taken, pairs);
  EXPECT_LE(left.taken + left.unpaired, kEach);
}

TEST(SensorInbox, ARequestToStopEndsTheWait) {
  const ManualClock clock;
  SensorInbox box(clock, {});
  bool came = true;
  std::jthread waiter([&](const std::stop_token& stop) { came = box.wait(1e6, stop); });
  waiter.request_stop();
  waiter.join();
  EXPECT_FALSE(came);
}

// A localization tells where the robot was a moment ago. By its own clock it would seem to be new.
TEST(SensorInbox, OfOneClockWhatIsAlwaysLateIsOld) {
  for (const bool one_clock : {false, true}) {
    SensorInboxOptions options;
    options.one_clock = one_clock;
    Inbox in(options);
    constexpr double kBehind = 1000.0;  // [s]
    for (int n = 0; n < 20; ++n) {
      in.clock.set(kNow + 0.1 * n);
      in.box.wheels(sample(in.clock.now() - kBehind));
      in.box.observe(ExternalPose{.stamp = in.clock.now() - kBehind - 0.15});
    }
    const double now = in.clock.now();
    EXPECT_NEAR(*in.box.count(SensorStream::kWheels).newest, now, 1e-3);
    EXPECT_NEAR(*in.box.count(SensorStream::kPose).newest, now - (one_clock ? 0.15 : 0.0), 1e-3);
  }
}

TEST(SensorInbox, APoseThatJumpsIsCountedAndMarked) {
  SensorInboxOptions options = in_one_clock();
  options.pose_jump.speed = options.pose_jump.yaw_rate = 1.0;
  Inbox in(options);
  for (const double x : {0.0, 0.05, 0.9, 0.95}) {
    in.clock.set(in.clock.now() + 0.05);
    ExternalPose pose{.stamp = in.clock.now()};
    pose.T_WB.translation().x() = x;
    in.box.observe(pose);
  }
  EXPECT_EQ(in.box.count(SensorStream::kPose).pose_jumps, 1);
  EXPECT_EQ(in.box.count(SensorStream::kPose).pose_jump, "by 0.90 m and 0.00 rad in 0.10 s");
  std::vector<int> jumps;
  while (const auto frame = in.box.take()) {
    jumps.push_back(std::get<ExternalPose>(*frame).jumps.count);
  }
  EXPECT_EQ(jumps, (std::vector<int>{0, 0, 1, 1}));
}

}  // namespace
}  // namespace prospect::sensor_inbox_test
