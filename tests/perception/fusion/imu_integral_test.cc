// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/imu_integral.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace prospect::imu_integral_test {
namespace {

using Eigen::Vector3d;

constexpr double kG = 9.81;

ImuSample sample(double stamp, const Vector3d& omega, const Vector3d& force) {
  ImuSample s;
  s.stamp = stamp;
  s.angular_velocity = omega;
  s.linear_acceleration = force;
  return s;
}

TEST(ImuIntegral, ATurnAndAWayAsTheyAre) {
  // On a circle of 2 m at 1 rad/s in the plane: f = (0, v^2 / r, g), a little noise against
  // repetition.
  ImuIntegral samples(5.0, 0.05);
  for (int k = 0; k <= 200; ++k) {
    EXPECT_EQ(samples.add(sample(0.01 * k, {0.0, 0.0, 1.0 + 0.01}, {1e-9 * k, 2.0, kG})), "");
  }
  const auto motion = samples.between(0.5, 1.5, {0.0, 0.0, 0.01});
  ASSERT_TRUE(motion);
  EXPECT_NEAR(Eigen::AngleAxisd(motion->R_B0B).angle(), 1.0, 1e-9);
  EXPECT_TRUE(motion->has_force);
  // The change of v = (2, 0) turned by 1 rad, and of the way beside v dt.
  EXPECT_NEAR(motion->velocity.x(), 2.0 * (std::cos(1.0) - 1.0), 1e-4);
  EXPECT_NEAR(motion->velocity.y(), 2.0 * std::sin(1.0), 1e-4);
  EXPECT_NEAR(motion->velocity.z(), kG, 1e-9);
  EXPECT_NEAR(motion->way.x(), 2.0 * (std::sin(1.0) - 1.0), 1e-4);
  EXPECT_NEAR(motion->way.y(), 2.0 * (1.0 - std::cos(1.0)), 1e-4);
  EXPECT_NEAR(motion->way.z(), 0.5 * kG, 1e-9);
}

TEST(ImuIntegral, BetweenSamplesIsInterpolatedAndTheAxesAreThoseOfB) {
  ImuIntegral samples(5.0, 0.2);
  for (int k = 0; k < 12; ++k) {
    ImuSample s = sample(0.1 * k, {0.1 * k, 0.0, 0.0}, {1e-6 * k, 0.0, kG});
    s.R_BS = Eigen::AngleAxisd(0.5 * M_PI, Vector3d::UnitZ());  // x of S is y of B
    EXPECT_EQ(samples.add(s), "");
  }
  // omega = t: the angle from 0.25 to 0.65 is (0.65^2 - 0.25^2) / 2.
  const auto motion = samples.between(0.25, 0.65, Vector3d::Zero());
  ASSERT_TRUE(motion);
  const Eigen::AngleAxisd turn(motion->R_B0B);
  EXPECT_NEAR(turn.angle(), 0.18, 1e-9);
  EXPECT_NEAR(turn.axis().y(), 1.0, 1e-9);
}

TEST(ImuIntegral, WhatIsNotCoveredIsNotToldAndWhatIsNoSampleIsRefused) {
  ImuIntegral samples(5.0, 0.05);
  EXPECT_FALSE(samples.between(0.0, 1.0, Vector3d::Zero()));
  const Vector3d up(0.0, 0.0, kG);
  for (int k = 0; k < 50; ++k) samples.add(sample(0.01 * k, {1e-4 * k, 0.0, 0.0}, up));
  EXPECT_TRUE(samples.between(0.1, 0.52, Vector3d::Zero()));
  EXPECT_FALSE(samples.between(0.1, 0.56, Vector3d::Zero()));  // ends before
  EXPECT_FALSE(samples.between(-0.2, 0.3, Vector3d::Zero()));  // begins later
  EXPECT_FALSE(samples.between(0.3, 0.3, Vector3d::Zero()));
  samples.add(sample(0.7, {0.0, 0.1, 0.0}, up));
  EXPECT_FALSE(samples.between(0.4, 0.7, Vector3d::Zero()));      // a hole
  EXPECT_NE(samples.add(sample(0.71, {0.0, 0.1, 0.0}, up)), "");  // hangs
  EXPECT_NE(samples.add(sample(0.72, {std::nan(""), 0.1, 0.0}, up)), "");
  EXPECT_NE(samples.add(sample(0.73, {1e3, 0.1, 0.0}, up)), "");
  EXPECT_NE(samples.add(sample(std::numeric_limits<double>::infinity(), {1.0, 0.1, 0.0}, up)), "");
  EXPECT_NE(samples.add(sample(0.6, {0.0, 0.3, 0.0}, up)), "");  // goes back
  EXPECT_EQ(samples.add(sample(0.74, {0.0, 0.2, 0.0}, up)), "");
}

TEST(ImuIntegral, AGyroAloneTellsNoWay) {
  ImuIntegral samples(5.0, 0.05);
  for (int k = 0; k < 50; ++k) {
    samples.add(sample(0.01 * k, {1e-4 * k, 0.0, 0.5}, Vector3d::Zero()));
  }
  const auto motion = samples.between(0.1, 0.3, Vector3d::Zero());
  ASSERT_TRUE(motion);
  EXPECT_FALSE(motion->has_force);
  EXPECT_EQ(motion->way, Vector3d::Zero());
}

}  // namespace
}  // namespace prospect::imu_integral_test
