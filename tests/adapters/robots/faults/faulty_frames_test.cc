// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/faults/faulty_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/maps/belief.h"

namespace prospect::faulty_frames_test {
namespace {

class Hand final : public Clock {
 public:
  double now() const noexcept override { return time; }
  bool wait_until(double, const std::stop_token&) const noexcept override { return true; }
  double time = 100.0;  // [s]
};

struct Broken {
  explicit Broken(const std::string& fault)
      : faults({parse_fault(fault + "@1+2")}),
        inbox(clock, FaultyFrames::inbox_options(in_runtime_clock(), faults)),
        frames(clock, inbox, faults, clock.now(), {0.5, 4.0}) {}
  static SensorInboxOptions in_runtime_clock() {
    SensorInboxOptions options;
    options.cameras_in_runtime_clock = options.depth_in_runtime_clock =
        options.scan_in_runtime_clock = options.poses_in_runtime_clock = true;
    return options;
  }
  /// A pair, a depth image, a scan and a pose each 0.1 s until so many seconds after the start;
  /// what comes.
  struct Came {
    std::vector<StereoFrame> pairs;
    std::vector<DepthFrame> depths;
    std::vector<ScanFrame> scans;
    std::vector<ExternalPose> poses;
  };
  Came until(double end) {
    Came came;
    for (; (clock.time = 100.05 + 0.1 * count) < 100.0 + end;) {
      const auto number = static_cast<std::uint8_t>(++count);
      const auto image = std::make_shared<const Image>(2, 1, number);
      frames.observe(StereoFrame{clock.time, clock.time, image, image});
      frames.observe(DepthFrame{clock.time, std::make_shared<const DepthImage>(2, 1, 2.0f)});
      DepthScan scan;
      scan.hits = {{1.0 * count, 0.0, 0.0}};
      frames.observe(ScanFrame{clock.time, std::make_shared<const DepthScan>(scan)});
      ExternalPose pose{.stamp = clock.time};
      pose.T_WB.translation().x() = count;
      frames.observe(pose);
      while (const auto frame = inbox.take()) {
        if (const auto* p = std::get_if<StereoFrame>(&*frame)) came.pairs.push_back(*p);
        if (const auto* d = std::get_if<DepthFrame>(&*frame)) came.depths.push_back(*d);
        if (const auto* s = std::get_if<ScanFrame>(&*frame)) came.scans.push_back(*s);
        if (const auto* e = std::get_if<ExternalPose>(&*frame)) came.poses.push_back(*e);
      }
    }
    return came;
  }
  int count = 0;
  Hand clock;
  const std::vector<InjectedFault> faults;
  SensorInbox inbox;
  FaultyFrames frames;
};

TEST(FaultyFrames, WhatIsOffDoesNotCome) {
  for (const char* fault : {"cameras:off", "left-camera:off", "right-camera:garbage",
                            "left-camera:wrong", "left-camera:stuck"}) {
    Broken b(fault);
    EXPECT_EQ(b.until(1.0).pairs.size(), 10U) << fault;
    const Broken::Came came = b.until(2.9);
    EXPECT_TRUE(came.pairs.empty()) << fault;
    EXPECT_EQ(came.depths.size(), 19U) << fault;
    EXPECT_EQ(came.poses.size(), std::string(fault) == "cameras:off" ? 0U : 19U) << fault;
    EXPECT_GT(b.until(4.0).pairs.size(), 8U) << fault;
  }
  Broken depth("depth:off");
  EXPECT_EQ(depth.until(1.0).depths.size(), 10U);
  const Broken::Came came = depth.until(2.9);
  EXPECT_EQ(came.pairs.size(), 19U);
  EXPECT_TRUE(came.depths.empty());
  EXPECT_TRUE(came.scans.empty());
}

TEST(FaultyFrames, WhatIsStuckComesWithNewStamps) {
  Broken b("cameras:stuck");
  b.until(1.0);
  const Broken::Came came = b.until(2.9);
  ASSERT_EQ(came.pairs.size(), 19U);
  EXPECT_EQ(came.pairs.back().left->at(0, 0), 10);
  EXPECT_NEAR(came.pairs.back().left_stamp, 102.85, 1e-9);
  EXPECT_EQ(came.poses.back().T_WB.translation().x(), 10.0);
  EXPECT_NEAR(came.poses.back().stamp, 102.85, 1e-9);
  Broken garbage("cameras:garbage");
  garbage.until(1.0);
  EXPECT_FALSE(garbage.until(2.0).poses.back().T_WB.matrix().allFinite());
  Broken depth("depth:stuck");
  depth.until(1.0);
  EXPECT_EQ(depth.until(2.9).scans.back().in_B->hits[0].x(), 10.0);
}

TEST(FaultyFrames, WhatIsSlowDelayedOrFailsAtTimes) {
  Broken slow("cameras:slow");
  slow.until(1.0);
  EXPECT_EQ(slow.until(3.0).pairs.size(), 1U);
  Broken late("depth:delayed");
  late.until(1.0);
  const Broken::Came came = late.until(2.0);
  ASSERT_GE(came.depths.size(), 6U);
  EXPECT_NEAR(came.depths.back().stamp, 101.95 - kFaultDelay, 0.11);
  Broken at_times("cameras:intermittent");
  at_times.until(1.0);
  EXPECT_EQ(at_times.until(2.0).pairs.size() + at_times.until(3.0).pairs.size(), 10U);
}

TEST(FaultyFrames, DepthsThatLie) {
  Broken wrong("depth:wrong");
  wrong.until(1.0);
  EXPECT_NEAR(wrong.until(2.0).depths.back().image->at(0, 0), 2.2, 1e-6);
  Broken garbage("depth:garbage");
  garbage.until(1.0);
  const Broken::Came came = garbage.until(2.0);
  const float first = came.depths.front().image->at(0, 0);
  EXPECT_TRUE(std::any_of(came.depths.begin(), came.depths.end(), [&](const DepthFrame& d) {
    return std::abs(d.image->at(0, 0) - first) > 0.1f;
  }));
  for (const DepthFrame& d : came.depths) {
    EXPECT_GE(d.image->at(1, 0), 0.5f);
    EXPECT_LE(d.image->at(1, 0), 4.0f);
  }
}

TEST(FaultyFrames, ScansThatLie) {
  const auto scan = [](const char* fault) {
    Broken b(fault);
    b.until(1.0);
    DepthScan rays;
    rays.origin = {0.0, 0.0, 1.0};
    rays.hits = {{2.0, 0.0, 1.0}};
    rays.misses = {{0.0, 3.0, 1.0}};
    Pose pose;
    pose.yaw = 0.5;
    b.clock.time = 101.5;
    b.frames.observe(ScanFrame{101.5, std::make_shared<const DepthScan>(rays),
                               std::make_shared<const Pose>(pose)});
    std::optional<ScanFrame> came;
    while (const auto frame = b.inbox.take()) came = std::get<ScanFrame>(*frame);
    EXPECT_EQ(came->pose->yaw, 0.5) << fault;
    return *came->in_B;
  };
  EXPECT_NEAR(scan("depth:wrong").hits[0].x(), 2.0 * kDepthScale, 1e-12);
  EXPECT_EQ(scan("depth:wrong").misses.size(), 1U);
  const DepthScan garbage = scan("depth:garbage");
  ASSERT_EQ(garbage.hits.size(), 2U) << "each ray ends somewhere";
  EXPECT_TRUE(garbage.misses.empty());
  for (const Eigen::Vector3d& hit : garbage.hits) {
    const double range = (hit - garbage.origin).norm();
    EXPECT_GE(range, 0.5);
    EXPECT_LE(range, 4.0);
  }
  EXPECT_NEAR(garbage.hits[1].x(), 0.0, 1e-12) << "along its direction";
}

// What a pair of cameras that are a model makes known is paired, stopped and held as images are.
TEST(FaultyFrames, ModelsOfCamerasAreBrokenAsCamerasAre) {
  const auto estimates = [](const std::string& fault) {
    Broken b(fault);
    std::vector<EstimateFrame> came;
    for (int k = 1; k < 30; ++k) {
      b.clock.time = 100.0 + 0.1 * k;
      auto made = std::make_shared<Belief>();
      made->pose.position.x() = k;
      b.frames.observe(EstimateFrame{b.clock.time, made});
      while (const auto frame = b.inbox.take()) came.push_back(std::get<EstimateFrame>(*frame));
    }
    return came;
  };
  for (const char* fault : {"cameras:off", "left-camera:off", "right-camera:garbage",
                            "left-camera:wrong", "right-camera:stuck", "cameras:garbage"}) {
    EXPECT_EQ(estimates(fault).size(), 9U) << fault;
  }
  const std::vector<EstimateFrame> stuck = estimates("cameras:stuck");
  ASSERT_EQ(stuck.size(), 29U);
  EXPECT_NEAR(stuck.back().stamp, 102.9, 1e-9);
  EXPECT_EQ(stuck.back().belief->pose.position.x(), 9.0);
  const std::vector<EstimateFrame> late = estimates("left-camera:delayed");
  EXPECT_NEAR(late.back().stamp, 102.9 - kFaultDelay, 0.11);
}

TEST(FaultyFrames, AClockThatJumpsIsOneOfItsOwn) {
  Broken b("clock:wrong");
  EXPECT_FALSE(b.until(1.0).pairs.empty()) << "its offset is known";
  EXPECT_TRUE(b.until(1.3).pairs.empty());
  EXPECT_EQ(b.inbox.count(SensorStream::kPair).jumps + b.inbox.count(SensorStream::kLeft).jumps, 1);
}

}  // namespace
}  // namespace prospect::faulty_frames_test
