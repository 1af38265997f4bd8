// SPDX-License-Identifier: Apache-2.0
#include "runtime/drive_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace prospect::drive_watch_test {
namespace {

/// Everything is well at 10 s, and has been seen so once.
class DriveWatchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    base_.connected = true;
    belief_.localization = Localization::kOk;
    seen_.belief = &belief_;
    seen_.base = &base_;
    at(10.0);
  }
  DriveFacts at(double now) {
    seen_.now = now;
    if (base_.connected && !silent_) base_.stamp = now;
    return watch_.facts(seen_);
  }

  DriveWatch watch_;
  DriveObservation seen_;
  BaseReport base_;
  Belief belief_;
  bool silent_ = false;
};

TEST_F(DriveWatchTest, CountsForHowLongItIsSo) {
  DriveFacts facts = at(10.5);
  EXPECT_DOUBLE_EQ(facts.live_for, 0.5);
  EXPECT_DOUBLE_EQ(facts.rest_for, 0.5);
  EXPECT_DOUBLE_EQ(facts.localized_for, 0.5);
  EXPECT_FALSE(facts.base_silent);
  belief_.localization = Localization::kDegraded;
  base_.velocity.yaw_rate = 0.1;
  seen_.stale_source = "the map is 2 s old";
  facts = at(10.6);
  EXPECT_EQ(facts.live_for, 0.0);
  EXPECT_EQ(facts.rest_for, 0.0);
  EXPECT_EQ(facts.localized_for, 0.0);
  EXPECT_EQ(facts.stale_source, "the map is 2 s old");
  base_.velocity.yaw_rate = 0.0;
  seen_.stale_source.clear();
  at(10.7);
  EXPECT_NEAR(at(10.9).live_for, 0.2, 1e-9);
  EXPECT_NEAR(at(10.9).rest_for, 0.2, 1e-9);
}

// Its clock is wrong, or its driver: it would never be missed.
TEST_F(DriveWatchTest, ABaseThatIsAheadOfTimeIsSilent) {
  silent_ = true;
  base_.stamp = 10.3;
  EXPECT_FALSE(at(10.1).base_silent);
  base_.stamp = 1e6;
  EXPECT_TRUE(at(10.2).base_silent);
  EXPECT_EQ(at(10.3).rest_for, 0.0);
}

TEST_F(DriveWatchTest, WithoutABeliefNothingIsLive) {
  seen_.belief = nullptr;
  const DriveFacts facts = at(11.0);
  EXPECT_EQ(facts.stale_source, "no belief yet");
  EXPECT_EQ(facts.localization, Localization::kLost);
  EXPECT_EQ(facts.live_for, 0.0);
}

TEST_F(DriveWatchTest, ABaseThatIsSilentIsNotAtRest) {
  silent_ = true;
  EXPECT_FALSE(at(10.4).base_silent);
  const DriveFacts facts = at(10.6);
  EXPECT_TRUE(facts.base_silent);
  EXPECT_EQ(facts.rest_for, 0.0);
  silent_ = false;
  EXPECT_FALSE(at(10.7).base_silent);
  base_.connected = false;
  EXPECT_FALSE(at(10.75).base_silent) << "one report that says so decides nothing";
  EXPECT_EQ(at(10.8).rest_for, 0.0) << "but it may be on its way";
  base_.connected = true;
  EXPECT_FALSE(at(10.85).base_silent);
  base_.connected = false;
  at(11.1);
  EXPECT_TRUE(at(11.4).base_silent);
  EXPECT_TRUE(DriveWatch().facts(seen_).base_silent) << "it was never there";
  base_.stamp = 11.5;
  EXPECT_TRUE(at(11.5).base_silent) << "a link that says that it is down is no word of the base";
}

// A base that reports rarely: what one report says lasts as long as a fault.
TEST_F(DriveWatchTest, OneReportOfAMotionThatNobodyAskedForDecidesNothing) {
  for (const double speed : {5.0, std::nan("")}) {
    base_.stamp += 1.0;
    silent_ = true;
    base_.velocity.linear.x() = speed;
    const double begin = seen_.now + 1.0;
    for (double now = begin; now < begin + 0.5; now += 0.05) {
      EXPECT_FALSE(at(now).uncommanded_motion) << now;
    }
    base_.velocity.linear.x() = 0.0;
    base_.stamp = seen_.now;
    EXPECT_FALSE(at(begin + 0.5).uncommanded_motion);
    silent_ = false;
    at(begin + 0.6);
    base_.velocity.linear.x() = speed;
    for (double now = begin + 0.7; now < begin + 1.2; now += 0.05) at(now);
    EXPECT_TRUE(at(begin + 1.2).uncommanded_motion) << "several do";
    base_.velocity.linear.x() = 0.0;
    for (double now = begin + 1.3; now < begin + 2.0; now += 0.05) at(now);
  }
}

TEST_F(DriveWatchTest, MotionThatNobodyAskedFor) {
  std::vector<SentCommand> sent = {{9.0, {{0.4, 0.0, 0.0}, 0.0}}, {10.0, {}}};
  seen_.sent = sent;
  base_.velocity.linear.x() = 0.5;
  // The command of 0.4 m/s counts for a second after it was replaced.
  EXPECT_FALSE(at(10.5).uncommanded_motion);
  EXPECT_FALSE(at(11.1).uncommanded_motion);
  EXPECT_FALSE(at(11.4).uncommanded_motion);
  EXPECT_TRUE(at(11.6).uncommanded_motion);
  base_.velocity.linear.x() = 0.1;
  EXPECT_FALSE(at(11.7).uncommanded_motion);
  base_.velocity.yaw_rate = -1.0;
  at(11.8);
  at(12.0);
  EXPECT_TRUE(at(12.3).uncommanded_motion);
}

TEST_F(DriveWatchTest, TheNewestCommandCountsHoweverOldItIs) {
  const std::vector<SentCommand> sent = {{5.0, {{0.6, 0.0, 0.0}, 1.0}}, {6.0, {}}};
  seen_.sent = std::span(sent).first(1);
  base_.velocity = {{0.6, 0.0, 0.0}, 1.0};
  for (double now = 10.5; now < 12.5; now += 0.1) EXPECT_FALSE(at(now).uncommanded_motion) << now;
}

TEST_F(DriveWatchTest, ThreadsAndFaultsByName) {
  seen_.threads = {{"perception", ThreadState::kOnTime}, {"planner", ThreadState::kLate}};
  EXPECT_EQ(at(10.1).late_thread, "planner");
  EXPECT_EQ(at(10.1).ended_thread, "");
  seen_.threads[1].state = ThreadState::kEnded;
  EXPECT_EQ(at(10.2).ended_thread, "planner");
  seen_.threads[1].state = ThreadState::kNeverStarted;
  EXPECT_EQ(at(10.3).late_thread, "planner");
  base_.faults = {"bumper pressed", "low battery"};
  EXPECT_EQ(at(10.4).base_fault, "bumper pressed");
}

TEST_F(DriveWatchTest, WhatIsToldIsHandedOn) {
  seen_.told_to_drive = seen_.emergency_stop = seen_.acknowledged = seen_.task_over = true;
  seen_.plan_from_rest = 9.5;
  seen_.plan_left = 0.7;
  seen_.obstacle = "a wall";
  seen_.yaw_checked = true;
  seen_.not_following = "backwards";
  EXPECT_FALSE(at(10.05).silent_emergency_stop.empty()) << "nobody has asked";
  seen_.silent_emergency_stop = "a button";
  const DriveFacts facts = at(10.1);
  EXPECT_TRUE(facts.told_to_drive && facts.emergency_stop && facts.acknowledged && facts.task_over);
  EXPECT_EQ(facts.plan_from_rest, 9.5);
  EXPECT_EQ(facts.plan_left, 0.7);
  EXPECT_EQ(facts.obstacle, "a wall");
  EXPECT_EQ(facts.not_following, "backwards");
  EXPECT_EQ(facts.silent_emergency_stop, "a button");
  EXPECT_EQ(facts.failed_preflight, "");
  EXPECT_TRUE(facts.yaw_checked);
}

TEST(DriveWatch, OptionsOutOfRangeAreRefused) {
  DriveWatchOptions options;
  options.max_silence = -1.0;
  EXPECT_THROW(DriveWatch{options}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::drive_watch_test
