// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/camera_time_offset.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "perception/odometry/se3.h"

namespace prospect::camera_time_offset_test {
namespace {

using Eigen::Isometry3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Motion = std::function<Isometry3d(double)>;  // T_CW at a time

constexpr double kPeriod = 0.1;  // [s]

Motion constant(const Vector6d& velocity) {
  return [velocity](double t) { return exp_se3(velocity * t); };
}
Motion driving() {  // 0.5 m/s ahead
  Vector6d xi = Vector6d::Zero();
  xi[2] = -0.5;
  return constant(xi);
}
Motion turning() {  // and 0.3 rad/s about the vertical
  Vector6d xi = Vector6d::Zero();
  xi[2] = -0.5;
  xi[4] = 0.3;
  return constant(xi);
}
Motion turning_on_the_spot() {
  Vector6d xi = Vector6d::Zero();
  xi[4] = 0.3;
  return constant(xi);
}
Motion pitching() {  // nodding instead
  Vector6d xi = Vector6d::Zero();
  xi[2] = -0.5;
  xi[3] = 0.3;
  return constant(xi);
}
/// In the hand: every direction swings by itself, about as fast as frames come.
Motion shaken() {
  return [](double t) {
    Vector6d xi;
    xi << 0.02 * std::sin(5.1 * t), 0.02 * std::sin(7.3 * t + 1.0), -0.4 * t,
        0.03 * std::sin(6.7 * t + 2.0), 0.04 * std::sin(4.3 * t), 0.02 * std::sin(5.9 * t + 3.0);
    return exp_se3(xi);
  };
}

/// What is wrong with the rows of the right image, besides time: at x and y from -1 to 1, at a
/// frame.
using Rows = std::function<double(double x, double y, int frame)>;

struct Scene {
  Motion motion;
  double tau = 0.0;  // [s]
  Rows rows = [](double, double, int) { return 0.0; };
  double shown = 1.0;  // share of the points that the right image shows
  int seed = 7;
};

/// Frames of a camera that moves, of 100 points each that are tracked as long as they are in view,
/// with noise of 0.1 px in the left and 0.2 px in the right image; every tenth one is a mismatch.
CameraTimeOffset after(int frames, const Scene& scene) {
  const StereoCamera camera;
  std::mt19937_64 generator(static_cast<std::uint64_t>(scene.seed));
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(generator() >> 11) / 9007199254740992.0;
  };
  const auto noise = [&](double sigma) {
    double sum = 0.0;
    for (int n = 0; n < 12; ++n) sum += sigma * uniform(-0.5, 0.5);
    return sum;
  };
  CameraTimeOffset offset;
  std::vector<Track> tracks;
  std::uint64_t next = 1;
  for (int k = 0; k < frames; ++k) {
    const double now = kPeriod * k;
    const Isometry3d T_CW = scene.motion(now), late = scene.motion(now + scene.tau);
    std::erase_if(tracks, [&](const Track& t) {
      const Eigen::Vector3d Y = T_CW * t.position;
      const Eigen::Vector2d p = camera.left.project(Y);
      return Y.z() < 0.5 || p.x() < 0.0 || p.x() > camera.left.width || p.y() < 0.0 ||
             p.y() > camera.left.height;
    });
    while (tracks.size() < 100) {
      Track& t = tracks.emplace_back();
      t.id = next++;
      const double u = uniform(0.0, camera.left.width), v = uniform(0.0, camera.left.height);
      const double z = uniform(1.0, 6.0);
      t.position = T_CW.inverse() * Eigen::Vector3d((u - camera.left.cx) / camera.left.fx * z,
                                                    (v - camera.left.cy) / camera.left.fy * z, z);
      t.inlier = true;
      t.in_right = uniform(0.0, 1.0) < scene.shown;
    }
    for (Track& t : tracks) {
      const Eigen::Vector2d p = camera.left.project(T_CW * t.position);
      t.left = Eigen::Vector2f(p.cast<float>());
      t.left.y() += static_cast<float>(noise(0.1));
      const double half = 0.5 * camera.left.width;
      const double error =
          camera.left.project(late * t.position).y() +
          scene.rows((p.x() - camera.left.cx) / half, (p.y() - camera.left.cy) / half, k) +
          noise(0.2) - t.left.y();
      t.row_error = static_cast<float>(error + (t.id % 10 ? 0.0 : 3.0));
    }
    const Isometry3d before = scene.motion(now - kPeriod);
    offset.update(camera, tracks, T_CW, log_se3(T_CW * before.inverse()) / kPeriod, now);
  }
  return offset;
}

TEST(CameraTimeOffset, IsFoundByEveryMotion) {
  for (const Motion& motion : {driving(), turning(), pitching(), shaken()}) {
    for (const double tau : {0.0, 0.02, -0.02, 0.1, -0.2}) {
      const CameraTimeOffset offset = after(60, {.motion = motion, .tau = tau});
      ASSERT_TRUE(offset.known()) << tau;
      EXPECT_NEAR(offset.value(), tau, 3.0 * offset.sigma() + 0.05 * std::abs(tau));
      EXPECT_LT(offset.sigma(), 0.02);
      EXPECT_EQ(offset.out_of_step(), tau != 0.0) << offset.value() << " " << offset.sigma();
    }
  }
}

TEST(CameraTimeOffset, IsNotWhatTheRectificationGetsWrong) {
  const Rows rows = [](double x, double, int) { return 0.4 + 0.3 * x; };
  const CameraTimeOffset offset = after(60, {.motion = turning(), .rows = rows});
  EXPECT_NEAR(offset.value(), 0.0, 3.0 * offset.sigma());
  EXPECT_FALSE(offset.out_of_step());
}

TEST(CameraTimeOffset, IsNotToldFromAYawOfTheRightCameraAtAConstantTurn) {
  // By as much as makes disparities wrong by half a pixel.
  const Rows rows = [](double x, double y, int) { return 0.5 * x * y; };
  const CameraTimeOffset offset =
      after(100, {.motion = turning_on_the_spot(), .tau = 0.0, .rows = rows});
  EXPECT_GT(offset.sigma(), 0.005);
  EXPECT_FALSE(offset.out_of_step());
  // Where it also drives, it is.
  const CameraTimeOffset told = after(100, {.motion = turning(), .tau = 0.02, .rows = rows});
  ASSERT_TRUE(told.known());
  EXPECT_NEAR(told.value(), 0.02, 3.0 * told.sigma());
  EXPECT_LT(told.sigma(), 0.005);
}

TEST(CameraTimeOffset, IsNoSurerThanErrorsThatFramesShareLetItBe) {
  // Rows of all points of a frame are wrong together, much as in the frame before.
  int answers = 0, wrong = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    std::mt19937 generator(static_cast<std::uint32_t>(seed));
    std::normal_distribution<double> normal;
    std::vector<std::array<double, 3>> shared(60);
    for (std::size_t k = 0; k < shared.size(); ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        shared[k][i] = (k > 0 ? 0.9 * shared[k - 1][i] : 0.0) + 0.1 * normal(generator);
      }
    }
    const Rows rows = [&](double x, double y, int frame) {
      const auto& s = shared[static_cast<std::size_t>(frame)];
      return s[0] + s[1] * x + s[2] * y;
    };
    const CameraTimeOffset offset =
        after(60, {.motion = shaken(), .tau = 0.01, .rows = rows, .seed = seed});
    answers += offset.known();
    const bool off = offset.known() && std::abs(offset.value() - 0.01) > 3.0 * offset.sigma();
    wrong += off;
    if (off) std::printf("seed %d: %.4f +- %.4f s\n", seed, offset.value(), offset.sigma());
  }
  EXPECT_GE(answers, 30);
  EXPECT_LE(wrong, 1);
}

TEST(CameraTimeOffset, IsNotKnown) {
  const double prior = CameraTimeOffsetOptions().prior_sigma;
  const CameraTimeOffset rests = after(60, {.motion = constant(Vector6d::Zero()), .tau = 0.02});
  // Rows that fit no time, and too few points that agree to say that they fit one.
  const CameraTimeOffset blind = after(60, {.motion = turning(), .tau = 0.02, .shown = 0.4});
  const CameraTimeOffset young = after(6, {.motion = turning(), .tau = 0.02});
  for (const CameraTimeOffset* offset : {&rests, &blind, &young}) {
    EXPECT_FALSE(offset->known());
    EXPECT_EQ(offset->value(), 0.0);
    EXPECT_EQ(offset->sigma(), prior);
    EXPECT_FALSE(offset->out_of_step());
  }
}

TEST(CameraTimeOffset, WhatItMayCostFallsAsItIsKnown) {
  EXPECT_EQ(CameraTimeOffset().depth_sigma(), 0.0);  // at rest it costs nothing
  const Scene turn{.motion = turning()};
  EXPECT_GT(after(1, turn).depth_sigma(), after(20, turn).depth_sigma());
  EXPECT_LT(after(20, turn).depth_sigma(), 0.02);
  const CameraTimeOffset late = after(20, {.motion = turning(), .tau = 0.02});
  EXPECT_GT(late.depth_sigma(), late.depth_error());
  EXPECT_GT(late.depth_error(), 0.02);
}

TEST(CameraTimeOffset, NamesWholeFrames) {
  const CameraTimeOffset late = after(60, {.motion = shaken(), .tau = 0.1});
  EXPECT_EQ(late.reason(0.1),
            "the right images are 1 frame late: pair each left image with the right one 1 before "
            "its own");
  EXPECT_EQ(late.reason(0.05).substr(0, 36), "the right images are 2 frames late: ");
  const CameraTimeOffset early = after(60, {.motion = shaken(), .tau = -0.1});
  EXPECT_EQ(early.reason(0.1).substr(0, 36), "the right images are 1 frame early: ");
  for (const double period : {0.0, 0.07, 1.0}) {
    const std::string reason = late.reason(period);
    EXPECT_EQ(reason.substr(0, 20), "the right camera is ");
    EXPECT_EQ(reason.substr(reason.size() - 7), "ms late");
  }
}

}  // namespace
}  // namespace prospect::camera_time_offset_test
