// SPDX-License-Identifier: Apache-2.0
#include "runtime/pose_jump.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "models/body_transform.h"

namespace prospect::pose_jump_test {
namespace {

constexpr double kSpeed = 0.6, kRate = 1.2;

PoseJumpOptions options() {
  PoseJumpOptions o;
  o.speed = kSpeed;
  o.yaw_rate = kRate;
  return o;
}

ExternalPose at(double stamp, double x, double yaw = 0.0) {
  return {.stamp = stamp, .T_WB = body_transform({{x, 1.0, 0.0}, yaw})};
}

TEST(PoseJumpWatch, WhatARobotCanDriveIsNoJump) {
  // As fast as it goes, at any rate of poses, with noise of 3 cm; and after a pause.
  for (const double period : {0.02, 0.1, 0.4, 1.0}) {
    PoseJumpWatch watch(options());
    for (int n = 0; n < 200; ++n) {
      const double t = period * n, noise = n % 2 == 0 ? 0.03 : -0.03;
      ExternalPose pose = at(t, kSpeed * t + noise, kRate * t + noise);
      EXPECT_EQ(watch.add(pose), "") << period << " " << n;
      EXPECT_EQ(pose.jumps.count, 0);
    }
  }
  PoseJumpWatch watch(options());
  ExternalPose before = at(0.0, 0.0), after = at(5.0, 2.9, 3.0);
  EXPECT_EQ(watch.add(before) + watch.add(after), "");
}

TEST(PoseJumpWatch, AJumpThatTheOdometryDidNotMakeIsACorrection) {
  PoseJumpWatch watch(options());
  const auto add = [&](double stamp, double x, double by_odometry) {
    ExternalPose pose = at(stamp, x);
    pose.T_OB = body_transform({{by_odometry, 0.0, 0.0}, 0.0});
    const std::string jumped = watch.add(pose);
    EXPECT_EQ(pose.jumps.count, jumped.empty() ? 0 : 1);
    return pose.corrections + (jumped.empty() ? 0 : 100);
  };
  EXPECT_EQ(add(0.0, 0.0, 7.0), 0);
  EXPECT_EQ(add(0.1, 0.05, 7.05), 0);
  EXPECT_EQ(add(0.2, 3.10, 7.10), 1);
  EXPECT_EQ(add(0.3, 3.15, 7.15), 1);
  EXPECT_EQ(add(0.4, 0.20, 7.20), 2) << "and back";
  EXPECT_EQ(add(0.5, 3.25, 9.25), 102) << "both: the robot, or its odometry, jumped";
}

TEST(PoseJumpWatch, AJumpIsNoticedAlsoIfItIsSpreadOverSeveralPoses) {
  struct Case {
    double x, yaw;
    int over;  // poses
  };
  for (const Case& c : {Case{0.8, 0.0, 1}, Case{0.0, 0.5, 1}, Case{-0.8, 0.0, 5},
                        Case{0.0, -1.5, 5}, Case{0.0, M_PI, 1}}) {
    PoseJumpWatch watch(options());
    std::string told;
    ExternalPose pose;
    for (int n = 0; n < 100; ++n) {
      const double share = std::clamp((n - 50) / double(c.over), 0.0, 1.0);
      pose = at(0.02 * n, 0.01 * n + share * c.x, share * c.yaw);
      const std::string now = watch.add(pose);
      if (n <= 50) {
        EXPECT_EQ(now, "");
      }
      if (told.empty()) told = now;
    }
    EXPECT_TRUE(told.starts_with("by ")) << c.x << " " << c.yaw;
    EXPECT_GE(pose.jumps.count, 1);
    EXPECT_LE(pose.jumps.count, c.over);
    // What it is off by is not told to be much less than it is.
    EXPECT_GE(pose.jumps.distance + pose.jumps.turn, 0.6 * (std::abs(c.x) + std::abs(c.yaw)));
  }
}

TEST(PoseJumpWatch, WithoutARobotNothingIsAJumpAndNoNumberIsNotCompared) {
  PoseJumpWatch any{PoseJumpOptions()};
  ExternalPose here = at(0.0, 0.0), there = at(0.1, 50.0, 3.0);
  EXPECT_EQ(any.add(here) + any.add(there), "");

  PoseJumpWatch watch(options());
  ExternalPose none = at(0.1, std::numeric_limits<double>::quiet_NaN());
  ExternalPose again = at(0.2, 0.05);
  EXPECT_EQ(watch.add(here) + watch.add(none) + watch.add(again), "");
}

}  // namespace
}  // namespace prospect::pose_jump_test
