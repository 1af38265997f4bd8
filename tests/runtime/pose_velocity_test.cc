// SPDX-License-Identifier: Apache-2.0
#include "runtime/pose_velocity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "models/body_transform.h"
#include "models/sinc.h"

namespace prospect::pose_velocity_test {
namespace {

Eigen::Isometry3d at(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(x, y, 0.2);
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// Of a body that drives an arc, at t.
Eigen::Isometry3d on_arc(double t, const Twist& twist, double yaw) {
  const double half = 0.5 * twist.yaw_rate * t;
  const Eigen::Vector2d way =
      sinc(half) * t * (Eigen::Rotation2Dd(yaw + half) * Eigen::Vector2d(twist.linear.head<2>()));
  return at(way.x(), way.y(), yaw + 2.0 * half);
}

PoseJumpOptions jumps() { return {.distance = 0.2, .turn = 0.2, .speed = 1.0, .yaw_rate = 1.5}; }

TEST(PoseVelocity, IsThatOfTheArcWhateverTheRateAndTheHeading) {
  for (const double rate : {100.0, 25.0, 5.0}) {
    for (const double yaw : {0.0, 3.0, -2.0}) {
      const Twist twist{{0.5, -0.1, 0.0}, 0.8};
      PoseVelocity measured(jumps());
      for (int n = 0; n < 40; ++n) {
        EXPECT_EQ(measured.velocity().has_value(), n >= 3);
        EXPECT_TRUE(measured.add(n / rate, on_arc(n / rate, twist, yaw)));
      }
      ASSERT_TRUE(measured.velocity());
      EXPECT_LT((measured.velocity()->linear - twist.linear).norm(), 5e-3) << rate;
      EXPECT_NEAR(measured.velocity()->yaw_rate, twist.yaw_rate, 1e-9) << rate;
    }
  }
}

TEST(PoseVelocity, ErrsAsTheHeaderSays) {
  constexpr double kSigma = 1e-3, kRate = 100.0, kWindow = 0.3;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, kSigma);
  double squares = 0.0;
  constexpr int kRuns = 2000;
  for (int run = 0; run < kRuns; ++run) {
    PoseVelocity measured(jumps());
    for (int n = 0; n <= 30; ++n) measured.add(n / kRate, at(noise(random), 0.0, 0.0));
    squares += std::pow(measured.velocity()->linear.x(), 2);
  }
  const double expected = kSigma * std::sqrt(12.0 / (kRate * std::pow(kWindow, 3)));
  EXPECT_NEAR(std::sqrt(squares / kRuns) / expected, 1.0, 0.1);
}

TEST(PoseVelocity, TakesNoJumpForMotionNorAnOldWordForANewOne) {
  PoseVelocity measured(jumps());
  for (int n = 0; n < 20; ++n) measured.add(0.02 * n, at(0.3 * 0.02 * n, 0.0, 0.0));
  const double now = 0.02 * 19;
  EXPECT_FALSE(measured.add(now, at(5.0, 0.0, 0.0)));
  EXPECT_FALSE(measured.add(now - 0.1, at(5.0, 0.0, 0.0)));
  EXPECT_FALSE(measured.add(std::numeric_limits<double>::quiet_NaN(), at(5.0, 0.0, 0.0)));
  EXPECT_FALSE(measured.add(now + 0.1, at(std::nan(""), 0.0, 0.0)));
  for (int n = 1; n < 20; ++n) {
    EXPECT_TRUE(measured.add(now + 0.02 * n, at(1.0 + 0.3 * 0.02 * n, 0.0, 0.0)));
    EXPECT_NEAR(measured.velocity()->linear.x(), 0.3, 1e-9);
  }
  // After a gap, of what comes then alone.
  for (int n = 0; n < 5; ++n) measured.add(now + 2.0 + 0.02 * n, at(1.5, 0.0, 0.0));
  EXPECT_NEAR(measured.velocity()->linear.x(), 0.0, 1e-9);
}

}  // namespace
}  // namespace prospect::pose_velocity_test
