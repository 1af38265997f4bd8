// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/pose_error.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <random>

namespace prospect::pose_error_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(PoseError, EveryCovarianceIsOneUpToRounding) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 2000; ++trial) {
    Eigen::Matrix4d A;
    for (double& a : A.reshaped()) a = normal(random);
    // Of every rank, and of scales as far apart as metres of position and microradians of yaw.
    const Eigen::Matrix4d Q = Eigen::HouseholderQR<Eigen::Matrix4d>(A).householderQ();
    Eigen::Vector4d d;
    for (double& v : d) v = random() % 3 ? std::pow(10.0, 6.0 * normal(random) / 3.0) : 0.0;
    EXPECT_TRUE(is_pose_covariance(Q * d.asDiagonal() * Q.transpose()));
    // With one direction of negative variance it is none.
    d[trial % 4] = -1e-3 * (d.maxCoeff() + 1e-3);
    EXPECT_FALSE(is_pose_covariance(Q * d.asDiagonal() * Q.transpose()));
  }
  EXPECT_TRUE(is_pose_covariance(Eigen::Matrix4d::Zero()));
}

TEST(PoseError, WhatCannotBeACovarianceIsNone) {
  const Eigen::Matrix4d good = 0.04 * Eigen::Matrix4d::Identity();
  ASSERT_TRUE(is_pose_covariance(good));
  EXPECT_FALSE(is_pose_covariance(-good));
  for (const double bad : {kNan, kInfinity, -kInfinity, -0.04, 1e13}) {
    for (const int at : {0, 1, 2, 3}) {
      Eigen::Matrix4d C = good;
      C(at, at) = bad;
      EXPECT_FALSE(is_pose_covariance(C)) << at << " " << bad;
      C = good;
      C(at, (at + 1) % 4) = bad;  // neither symmetric nor small
      EXPECT_FALSE(is_pose_covariance(C)) << at << " " << bad;
      C((at + 1) % 4, at) = bad;
      EXPECT_EQ(is_pose_covariance(C), bad == -0.04);  // a correlation of -1 is possible
    }
  }
  Eigen::Matrix4d C = good;
  C(0, 1) = C(1, 0) = 0.041;  // of more than 1 it is not
  EXPECT_FALSE(is_pose_covariance(C));
}

TEST(PoseError, SigmaIsThatOfTheWorstDirection) {
  Eigen::Matrix4d C = Eigen::Matrix4d::Zero();
  C(3, 3) = 9.0;  // of yaw
  EXPECT_EQ(position_sigma(C), 0.0);
  C(0, 0) = C(1, 1) = 0.05;
  C(0, 1) = C(1, 0) = 0.04;
  EXPECT_NEAR(position_sigma(C), 0.3, 1e-12);
}

TEST(PoseError, IsUnboundedWhenLostFarOffOrWithoutACovariance) {
  Belief belief;
  EXPECT_EQ(unbounded_pose_error(belief, 1.0), "");
  belief.covariance = 25.0 * Eigen::Matrix4d::Identity();
  EXPECT_EQ(unbounded_pose_error(belief, 1.0), "") << "not lost: off against the start";
  belief.localization = Localization::kLost;
  EXPECT_NE(unbounded_pose_error(belief, 1.0), "");
  EXPECT_EQ(unbounded_pose_error(belief, 5.1), "");
  EXPECT_EQ(unbounded_pose_error(belief, kInfinity), "");
  belief.covariance *= 0.01;
  EXPECT_EQ(unbounded_pose_error(belief, 1.0), "");
  belief.covariance.setZero();
  EXPECT_NE(unbounded_pose_error(belief, kInfinity), "") << "lost and exact";
  for (const Localization state :
       {Localization::kOk, Localization::kDegraded, Localization::kLost}) {
    belief.localization = state;
    belief.covariance = -0.04 * Eigen::Matrix4d::Identity();
    EXPECT_NE(unbounded_pose_error(belief, kInfinity), "");
    belief.covariance.setIdentity();
    belief.covariance(2, 1) = kNan;
    EXPECT_NE(unbounded_pose_error(belief, kInfinity), "");
  }
}

}  // namespace
}  // namespace prospect::pose_error_test
