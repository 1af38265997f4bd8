// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/camera_time_offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "perception/odometry/se3.h"

namespace prospect::camera_time_offset_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Frames of a camera that moves, of 100 points each, whose rows in the right image are late by
/// `tau` [s], lower by `row` [px] and turned by `roll` [px at the image's edge], with noise of 0.2
/// px; every tenth one is a mismatch.
CameraTimeOffset after(const Vector6d& velocity, double tau, int frames, double row = 0.0,
                       double roll = 0.0) {
  const StereoCamera camera;
  std::mt19937_64 generator(7);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(generator() >> 11) / 9007199254740992.0;
  };
  CameraTimeOffset offset;
  const Isometry3d here = Isometry3d::Identity();
  for (int k = 0; k < frames; ++k) {
    std::vector<Track> tracks(100);
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      Track& t = tracks[i];
      const double u = uniform(0.0, camera.left.width), v = uniform(0.0, camera.left.height);
      const double z = uniform(1.0, 6.0);
      t.position = {(u - camera.left.cx) / camera.left.fx * z,
                    (v - camera.left.cy) / camera.left.fy * z, z};
      t.left = {static_cast<float>(u), static_cast<float>(v)};
      t.inlier = t.in_right = true;
      const double late = camera.left.project(exp_se3(velocity * tau) * t.position).y() - v;
      const double turned = roll * (u - camera.left.cx) / (0.5 * camera.left.width);
      double noise = 0.0;
      for (int n = 0; n < 12; ++n) noise += 0.2 * uniform(-0.5, 0.5);
      t.row_error = static_cast<float>(late + row + turned + noise + (i % 10 ? 0.0 : 3.0));
    }
    offset.update(camera, tracks, here, velocity);
  }
  return offset;
}

Vector6d driving() {  // 0.5 m/s ahead
  Vector6d xi = Vector6d::Zero();
  xi[2] = -0.5;
  return xi;
}
Vector6d turning() {  // and 0.3 rad/s about the vertical
  Vector6d xi = driving();
  xi[4] = 0.3;
  return xi;
}
Vector6d pitching() {  // nodding instead
  Vector6d xi = driving();
  xi[3] = 0.3;
  return xi;
}

TEST(CameraTimeOffset, IsFoundByEveryMotion) {
  for (const Vector6d& velocity : {driving(), turning(), pitching()}) {
    for (const double tau : {0.0, 0.02, -0.02, 0.1}) {
      const CameraTimeOffset offset = after(velocity, tau, 40);
      EXPECT_NEAR(offset.value(), tau, 3.0 * offset.sigma() + 0.05 * std::abs(tau));
      EXPECT_LT(offset.sigma(), 0.02);
      EXPECT_EQ(offset.out_of_step(), tau != 0.0) << offset.value() << " " << offset.sigma();
    }
  }
}

TEST(CameraTimeOffset, IsNotWhatTheRectificationGetsWrong) {
  const CameraTimeOffset offset = after(turning(), 0.0, 40, 0.4, 0.3);
  EXPECT_NEAR(offset.value(), 0.0, 3.0 * offset.sigma());
  EXPECT_FALSE(offset.out_of_step());
}

TEST(CameraTimeOffset, IsNotKnownAtRest) {
  const CameraTimeOffset offset = after(Vector6d::Zero(), 0.02, 40);
  EXPECT_NEAR(offset.sigma(), CameraTimeOffsetOptions().prior_sigma, 1e-3);
  EXPECT_FALSE(offset.out_of_step());
}

TEST(CameraTimeOffset, WhatItMayCostFallsAsItIsKnown) {
  EXPECT_EQ(CameraTimeOffset().depth_sigma(), 0.0);  // at rest it costs nothing
  EXPECT_GT(after(turning(), 0.0, 1).depth_sigma(), after(turning(), 0.0, 20).depth_sigma());
  EXPECT_LT(after(turning(), 0.0, 20).depth_sigma(), 0.01);
  const CameraTimeOffset late = after(turning(), 0.02, 20);
  EXPECT_GT(late.depth_sigma(), late.depth_error());
  EXPECT_GT(late.depth_error(), 0.02);
}

TEST(CameraTimeOffset, NamesWholeFrames) {
  const CameraTimeOffset late = after(turning(), 0.1, 40);
  EXPECT_EQ(late.reason(0.1),
            "the right images are 1 frame late: pair each left image with the right one 1 before "
            "its own");
  EXPECT_EQ(late.reason(0.05).substr(0, 36), "the right images are 2 frames late: ");
  const CameraTimeOffset early = after(turning(), -0.1, 40);
  EXPECT_EQ(early.reason(0.1).substr(0, 36), "the right images are 1 frame early: ");
  for (const double period : {0.0, 0.07, 1.0}) {
    const std::string reason = late.reason(period);
    EXPECT_EQ(reason.substr(0, 20), "the right camera is ");
    EXPECT_EQ(reason.substr(reason.size() - 7), "ms late");
  }
}

}  // namespace
}  // namespace prospect::camera_time_offset_test
