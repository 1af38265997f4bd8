// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/belief_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "models/camera.h"
#include "perception/odometry/se3.h"

namespace prospect::belief_builder_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d pose_matrix(const Pose& pose) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(pose.yaw, Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = pose.position;
  return T;
}

TEST(BeliefBuilder, CarriesPoseTwistAndCovarianceToTheBody) {
  const Isometry3d T_BC = CameraMount::forward_facing({0.2, 0.1, 0.6}, 0.3, -0.1);
  const LandmarkMap landmarks;
  BeliefBuilder builder(T_BC);
  // A quarter of a circle of 1 m about (0, 1), in ten frames of 0.1 s: 1.57 m/s, 1.57 rad/s.
  OdometryFrame frame;
  Belief belief;
  for (int k = 0; k <= 10; ++k) {
    const double a = 0.05 * M_PI * k;
    frame.stamp = 0.1 * k;
    frame.state = Localization::kOk;
    frame.tracked = 80;
    frame.T_WC = pose_matrix({{std::sin(a), 1.0 - std::cos(a), 0.0}, a}) * T_BC;
    frame.covariance = 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
    belief = builder.build(frame, {}, landmarks);
  }
  EXPECT_LT((belief.pose.position - Vector3d(1, 1, 0)).norm(), 1e-12);
  EXPECT_NEAR(belief.pose.yaw, 0.5 * M_PI, 1e-12);
  EXPECT_NEAR(belief.twist.linear.x(), 0.5 * M_PI, 0.01);
  EXPECT_NEAR(belief.twist.linear.y(), 0.0, 1e-12);
  EXPECT_NEAR(belief.twist.yaw_rate, 0.5 * M_PI, 1e-12);
  EXPECT_EQ(belief.tracked_features, 80);
  // Once more at the same frame: nothing stands still.
  EXPECT_EQ(builder.build(frame, {}, landmarks).twist.yaw_rate, belief.twist.yaw_rate);
  // Against differences of the pose.
  Eigen::Matrix<double, 4, 6> J;
  for (int i = 0; i < 6; ++i) {
    const double h = 1e-6;
    const auto moved = [&](double s) {
      const Eigen::Matrix<double, 6, 1> e = s * Eigen::Matrix<double, 6, 1>::Unit(i);
      const Isometry3d T_WB = (exp_se3(e) * frame.T_WC.inverse()).inverse() * T_BC.inverse();
      return Eigen::Vector4d(T_WB.translation().x(), T_WB.translation().y(), T_WB.translation().z(),
                             std::atan2(T_WB.linear()(1, 0), T_WB.linear()(0, 0)));
    };
    J.col(i) = (moved(h) - moved(-h)) / (2 * h);
  }
  EXPECT_LT((belief.covariance - 1e-4 * J * J.transpose()).norm(), 1e-10);
  // Lost: the pose is held, the twist only for a while.
  frame.state = Localization::kLost;
  frame.tracked = 0;
  frame.stamp = 1.2;
  belief = builder.build(frame, {}, landmarks);
  EXPECT_EQ(belief.localization, Localization::kLost);
  EXPECT_NEAR(belief.twist.yaw_rate, 0.5 * M_PI, 1e-12);
  frame.stamp = 2.0;
  EXPECT_EQ(builder.build(frame, {}, landmarks).twist.yaw_rate, 0.0);
  Isometry3d wrong = T_BC;
  wrong.linear() *= 2.0;
  EXPECT_THROW(BeliefBuilder{wrong}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::belief_builder_test
