// SPDX-License-Identifier: Apache-2.0
#include "runtime/belief_source.h"

#include <gtest/gtest.h>

#include <memory>
#include <stop_token>
#include <vector>

#include "runtime/clock.h"

namespace prospect::belief_source_test {
namespace {

class CountedFrames final : public MissionObserver {
 public:
  void on_frame(const SensorFrame& frame) override { stamps.push_back(stamp_of(frame)); }
  std::vector<double> stamps;
};

/// A robot whose pose comes from outside.
class PipelineBeliefsTest : public ::testing::Test {
 protected:
  PipelineBeliefsTest() { beliefs_.watched_by({&seen_}); }
  static SensorInboxOptions options() {
    SensorInboxOptions options;
    options.cameras_in_runtime_clock = options.poses_in_runtime_clock = true;
    return options;
  }
  static PerceptionOptions without_wheels() {
    PerceptionOptions options;
    options.wheels = false;
    return options;
  }
  void pose(double stamp, double x) {
    ExternalPose pose;
    pose.stamp = stamp;
    pose.T_WB.translation().x() = x;
    inbox_.observe(pose);
  }

  ManualClock clock_{100.0};
  SensorInbox inbox_{clock_, options()};
  PerceptionPipeline perception_{without_wheels()};
  PipelineBeliefs beliefs_{inbox_, perception_};
  CountedFrames seen_;
};

TEST_F(PipelineBeliefsTest, NothingComesOfNothing) {
  EXPECT_EQ(beliefs_.update({}), nullptr);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(beliefs_.update(stop.get_token()), nullptr);
  EXPECT_TRUE(seen_.stamps.empty());
}

TEST_F(PipelineBeliefsTest, WhatWaitsIsWorkedInAndToldInItsOrder) {
  pose(99.9, 1.0);
  const std::shared_ptr<const Belief> belief = beliefs_.update({});
  ASSERT_NE(belief, nullptr);
  EXPECT_EQ(belief->pose.position.x(), 1.0);
  EXPECT_EQ(belief->stamp, 99.9);
  pose(99.95, 1.01);
  inbox_.pair(99.92, 99.92, {Image(2, 2, 7), Image(2, 2, 8)});
  EXPECT_EQ(beliefs_.update({})->stamp, 99.95);
  EXPECT_EQ(seen_.stamps, (std::vector<double>{99.9, 99.92, 99.95}));
  EXPECT_EQ(beliefs_.known()->stamp, 99.95);
}

TEST_F(PipelineBeliefsTest, CorrectionsComeThroughTheInbox) {
  pose(99.9, 1.0);
  EXPECT_EQ(beliefs_.update({})->map_frame, nullptr);
  Correction correction;
  correction.T_new_old.translation().x() = 3.0;
  correction.why = "SLAM";
  for (int k = 0; k < 1000; ++k) inbox_.observe(correction);  // at once
  const std::shared_ptr<const Belief> belief = beliefs_.update({});
  ASSERT_NE(belief, nullptr);
  EXPECT_EQ(belief->pose.position.x(), 1.0);
  EXPECT_EQ(belief->map_frame->origin.position.x(), 3.0);
  EXPECT_EQ(belief->map_frame->taken, 1);
  EXPECT_GT(belief->map_frame->refused, 0);
  EXPECT_NE(belief->map_frame->refusal.find("(SLAM)"), std::string::npos);
}

TEST_F(PipelineBeliefsTest, WhoDeliversWithoutEndKeepsNoBeliefBack) {
  for (int k = 1; k <= 50; ++k) pose(99.5 + 0.001 * k, 0.0);
  EXPECT_NEAR(beliefs_.update({})->stamp, 99.532, 1e-9);
  EXPECT_NEAR(beliefs_.update({})->stamp, 99.55, 1e-9);
  EXPECT_EQ(seen_.stamps.size(), 50U);
}

// Of cameras that nobody localizes by there are no landmarks, but a picture, once.
TEST_F(PipelineBeliefsTest, APictureIsToldOnce) {
  EXPECT_EQ(beliefs_.picture().image, nullptr);
  inbox_.pair(99.9, 99.9, {Image(2, 2, 7), Image(2, 2, 8)});
  beliefs_.update({});
  const CameraPicture picture = beliefs_.picture();
  ASSERT_NE(picture.image, nullptr);
  EXPECT_EQ(picture.image->pixels[0], 7);
  EXPECT_TRUE(picture.sightings.empty());
  EXPECT_EQ(beliefs_.picture().image, nullptr);
}

}  // namespace
}  // namespace prospect::belief_source_test
