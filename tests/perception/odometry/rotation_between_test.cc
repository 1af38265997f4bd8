// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/rotation_between.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace prospect::rotation_between_test {
namespace {

using Eigen::Vector3d;

TEST(RotationBetween, TurnsOneDirectionIntoTheOtherByTheSmallestAngle) {
  const Vector3d from(0.3, -2.0, 0.4), to(5.0, 1.0, -0.7);
  const Eigen::Quaterniond q = rotation_between(from, to);
  EXPECT_NEAR((q * from.normalized() - to.normalized()).norm(), 0.0, 1e-14);
  EXPECT_NEAR(Eigen::AngleAxisd(q).angle(), std::atan2(from.cross(to).norm(), from.dot(to)), 1e-14);
  EXPECT_NEAR(q.vec().dot(from), 0.0, 1e-14);
}

TEST(RotationBetween, OppositeDirectionsAreAHalfTurnApart) {
  const Eigen::Quaterniond q = rotation_between(Vector3d::UnitZ(), -2.0 * Vector3d::UnitZ());
  EXPECT_NEAR((q * Vector3d::UnitZ() + Vector3d::UnitZ()).norm(), 0.0, 1e-14);
  EXPECT_NEAR(q.norm(), 1.0, 1e-14);
}

}  // namespace
}  // namespace prospect::rotation_between_test
