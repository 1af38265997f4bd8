// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/second_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "perception/odometry/se3.h"

namespace prospect::second_motion_test {
namespace {

using Eigen::Isometry3d;
using Vector6d = SecondMotion::Vector6d;
using Matrix6d = SecondMotion::Matrix6d;

Isometry3d moved(double x, double yaw = 0.0) {
  Vector6d xi = Vector6d::Zero();
  xi[0] = x;
  xi[4] = yaw;
  return exp_se3(xi);
}

MotionHypothesis hypothesis(int cells, double depth, const Isometry3d& T_CW) {
  MotionHypothesis h;
  h.T_CW = T_CW;
  h.depth = depth;
  h.cells = cells;
  return h;
}

TEST(SecondMotion, TheWorldIsLargerAndFartherAndMovesAsBefore) {
  const Isometry3d here = Isometry3d::Identity();
  MotionExpectation unknown;
  const auto odds = [&](int a, double depth_a, int b, double depth_b) {
    return world_log_odds(hypothesis(a, depth_a, here), hypothesis(b, depth_b, here), unknown);
  };
  EXPECT_EQ(odds(10, 2.0, 10, 2.05), 0.0);
  EXPECT_NEAR(odds(20, 2.0, 10, 2.0), 2.0 * std::log(2.0), 1e-12);
  EXPECT_GT(odds(10, 3.0, 20, 1.0), 0.0);  // a board that is carried, before a wall
  EXPECT_LT(odds(10, 3.0, 40, 1.0), 0.0);
  EXPECT_EQ(odds(10, 3.0, 17, 1.0), -odds(17, 1.0, 10, 3.0));

  MotionPrior prior;
  MotionExpectation expected;
  expected.T_CW = moved(0.05);
  expected.dt = 0.1;
  expected.prior = &prior;
  // A person who walks by, nearer or not, would be a jump.
  EXPECT_GT(
      world_log_odds(hypothesis(10, 2.0, moved(0.05)), hypothesis(12, 2.0, moved(0.6)), expected),
      4.0);
}

TEST(SecondMotion, TheCovarianceCoversBothPoses) {
  SecondMotion second;
  EXPECT_FALSE(second.seen());
  EXPECT_TRUE(second.covariance(moved(1.0)).isZero());
  // Three to one, from (0, 0) on: the camera has gone by 0.4 m, or it has not.
  second.begin(Isometry3d::Identity(), 1.0, std::nullopt, std::log(3.0));
  EXPECT_NEAR(second.probability(), 0.25, 1e-12);
  ASSERT_TRUE(second.expected(1.1));
  EXPECT_TRUE(second.expected(1.1)->isApprox(Isometry3d::Identity()));
  const SecondMotion::Sum start = second.sum();
  second.see(moved(0.4), Isometry3d::Identity(), 1.1);
  EXPECT_NEAR(second.covariance(moved(0.4))(0, 0), 0.25 * 0.16, 1e-12);
  EXPECT_NEAR(second.covariance_since(start, moved(0.4))(0, 0), 0.25 * 0.16, 1e-12);
  // It goes on as it did.
  second.see(moved(0.4), moved(0.1), 1.2);
  EXPECT_NEAR(second.expected(1.3)->translation().x(), 0.2, 1e-9);
  EXPECT_NEAR(second.covariance(moved(0.4))(0, 0), 0.25 * 0.09, 1e-12);

  // Out of sight it stays as far away, whichever way the camera turns.
  second.end();
  EXPECT_FALSE(second.seen());
  EXPECT_EQ(second.probability(), 0.0);
  const SecondMotion::Sum then = second.sum();
  const Isometry3d turned = moved(0.0, 0.5 * M_PI) * moved(0.4);
  const auto position_variance = [&] { return second.covariance(turned).diagonal().head(3).sum(); };
  EXPECT_NEAR(position_variance(), 0.25 * 0.09, 1e-9);
  EXPECT_NEAR(second.covariance(turned)(2, 2), 0.25 * 0.09, 1e-9);
  EXPECT_TRUE(second.covariance_since(then, turned).isZero());
  // Another one is independent of it.
  second.begin(turned, 2.0, std::nullopt, 0.0);
  second.see(turned, moved(0.2) * turned, 2.1);
  EXPECT_NEAR(position_variance(), 0.25 * 0.09 + 0.5 * 0.04, 1e-9);
}

TEST(SecondMotion, WhatIsNotKnownGrowsWithTheTime) {
  SecondMotion second;
  second.unknown(0.1);
  const SecondMotion::Sum then = second.sum();
  const double once = second.covariance(moved(0.0))(0, 0);
  EXPECT_NEAR(once, std::pow(0.1 * SecondMotion::kUnknownSpeed, 2), 1e-12);
  for (int k = 0; k < 9; ++k) second.unknown(0.1);
  EXPECT_NEAR(second.covariance(moved(0.0))(0, 0), 100.0 * once, 1e-9);
  EXPECT_NEAR(second.covariance_since(then, moved(3.0))(0, 0), 81.0 * once, 1e-9);
}

}  // namespace
}  // namespace prospect::second_motion_test
