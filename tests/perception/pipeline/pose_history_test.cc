// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/pose_history.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "models/body_transform.h"

namespace prospect::pose_history_test {
namespace {

BodyPose pose(double x, double yaw) {
  BodyPose body;
  body.pose = {{x, -x, 0.1}, yaw};
  body.T_WB = body_transform(body.pose);
  return body;
}

TEST(PoseHistory, InterpolatesWithinItsSpan) {
  PoseHistory history(1.0);
  EXPECT_FALSE(history.at(0.0));
  EXPECT_FALSE(history.newest());
  history.add(10.0, pose(1.0, 3.0));
  EXPECT_EQ(history.at(10.0)->pose.yaw, 3.0);
  history.add(10.4, pose(2.0, 3.0 - 2.0 * M_PI + 0.4));  // a turn by 0.4, past pi
  EXPECT_EQ(history.newest(), 10.4);
  const Pose between = history.at(10.1)->pose;
  EXPECT_LT((between.position - Eigen::Vector3d(1.25, -1.25, 0.1)).norm(), 1e-12);
  EXPECT_NEAR(between.yaw, 3.1, 1e-12);
  EXPECT_FALSE(history.at(9.99));
  EXPECT_FALSE(history.at(10.41));
  // 10.1 to 11.1 are known then, as 10.0 is needed for that.
  history.add(11.1, pose(3.0, 0.0));
  EXPECT_TRUE(history.at(10.1));
  history.add(11.5, pose(3.0, 0.0));
  EXPECT_FALSE(history.at(10.39));
  EXPECT_TRUE(history.at(10.5));
}

TEST(PoseHistory, InterpolatesInSpaceAndTakesTheWorseState) {
  PoseHistory history(1.0);
  BodyPose a, b;
  b.T_WB.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()).toRotationMatrix();
  b.T_WB.translation() << 0.0, 1.0, 2.0;
  b.state = Localization::kDegraded;
  history.add(1.0, a);
  history.add(2.0, b);
  EXPECT_EQ(history.at(1.0)->state, Localization::kOk);
  const BodyPose between = *history.at(1.25);
  EXPECT_EQ(between.state, Localization::kDegraded);
  EXPECT_LT((between.T_WB.translation() - Eigen::Vector3d(0.0, 0.25, 0.5)).norm(), 1e-12);
  EXPECT_TRUE(between.T_WB.linear().isApprox(
      Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()).toRotationMatrix(), 1e-12));
}

}  // namespace
}  // namespace prospect::pose_history_test
