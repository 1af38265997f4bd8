#include "perception/pipeline/pose_history.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

namespace prospect::pose_history_test {
namespace {

Pose pose(double x, double yaw) { return {{x, -x, 0.1}, yaw}; }

TEST(PoseHistory, InterpolatesWithinItsSpan) {
  PoseHistory history(1.0);
  EXPECT_FALSE(history.at(0.0));
  EXPECT_FALSE(history.newest());
  history.add(10.0, pose(1.0, 3.0));
  EXPECT_EQ(history.at(10.0)->yaw, 3.0);
  history.add(10.4, pose(2.0, 3.0 - 2.0 * M_PI + 0.4));  // a turn by 0.4, past pi
  EXPECT_EQ(history.newest(), 10.4);
  const Pose between = *history.at(10.1);
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

}  // namespace
}  // namespace prospect::pose_history_test
