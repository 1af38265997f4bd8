// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/trusted_pose.h"

#include <gtest/gtest.h>

namespace prospect::trusted_pose_test {
namespace {

using Eigen::Isometry3d;

Isometry3d at(double x) { return Isometry3d(Eigen::Translation3d(x, 0.0, 0.0)); }

TEST(TrustedPose, GoesOnAsItDidForAWhile) {
  TrustedPose pose;
  pose.take(at(0.2), 0.1, {});
  ASSERT_TRUE(pose.velocity);
  EXPECT_NEAR((*pose.velocity)[0], 2.0, 1e-12);
  EXPECT_NEAR(pose.continued(0.3).translation().x(), 0.6, 1e-12);
  EXPECT_NEAR(pose.continued(9.0).translation().x(), 1.2, 1e-12);  // half a second of it
  EXPECT_NEAR(pose.continued(1.6, 5.0).translation().x(), 3.2, 1e-12);
}

TEST(TrustedPose, KnowsNoMotionAfterLong) {
  TrustedPose pose;
  pose.take(at(0.2), 0.1, {});
  pose.take(at(0.4), 1.2, {});
  EXPECT_FALSE(pose.velocity);
  EXPECT_EQ(pose.stamp, 1.2);
}

}  // namespace
}  // namespace prospect::trusted_pose_test
