// SPDX-License-Identifier: Apache-2.0
#include "models/multirotor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace prospect::multirotor_test {
namespace {

Eigen::VectorXd state(double vx, double vy, double vz, double psi) {
  Eigen::VectorXd x(7);
  x << 1.0, 2.0, 3.0, vx, vy, vz, psi;
  return x;
}

TEST(Multirotor, FollowsConstantAcceleration) {
  const Multirotor model;
  Eigen::VectorXd next(7), expected(7);
  model.step(state(0.5, -0.5, 0.25, 3.0), Eigen::Vector4d(1.0, 2.0, -0.5, 0.5), 2.0, next);
  expected << 1.0 + 1.0 + 2.0, 2.0 - 1.0 + 4.0, 3.0 + 0.5 - 1.0, 2.5, 3.5, -0.75, 4.0;
  EXPECT_EQ(next, expected);
}

TEST(Multirotor, TwistIsTheVelocitySeenFromTheHeading) {
  const Multirotor model;
  const Twist twist =
      model.twist(state(0.0, 0.7, -0.2, std::numbers::pi / 2.0), Eigen::Vector4d(0, 0, 0, 0.3));
  EXPECT_NEAR(twist.linear.x(), 0.7, 1e-15);
  EXPECT_NEAR(twist.linear.y(), 0.0, 1e-15);
  EXPECT_NEAR(twist.linear.z(), -0.2, 1e-15);
  EXPECT_EQ(twist.yaw_rate, 0.3);
}

TEST(Multirotor, SpeedRowsVanishAtTheBoundAndMeasureTheMarginNearIt) {
  const Multirotor model;  // 1.5 m/s level, 0.8 m/s up and down
  Eigen::VectorXd rows(3);
  for (double angle = 0.0; angle < 6.3; angle += 0.1) {
    const double c = std::cos(angle), s = std::sin(angle);
    model.state_constraints(state(1.5 * c, 1.5 * s, 0.8, 0.0), rows, nullptr);
    EXPECT_NEAR(rows[0], 0.0, 1e-15);
    EXPECT_NEAR(rows[1], 0.0, 1e-15);
    EXPECT_NEAR(rows[2], 1.6, 1e-15);
    model.state_constraints(state(1.49 * c, 1.49 * s, -0.9, 0.0), rows, nullptr);
    EXPECT_NEAR(rows[0], 0.01, 1e-4);
    EXPECT_NEAR(rows[2], -0.1, 1e-15);
  }
}

TEST(Multirotor, ItsPoseIsThreeDimensional) {
  const Multirotor model;
  const Pose pose = model.pose(state(0, 0, 0, 0.4));
  EXPECT_EQ(pose.position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(pose.yaw, 0.4);
}

}  // namespace
}  // namespace prospect::multirotor_test
