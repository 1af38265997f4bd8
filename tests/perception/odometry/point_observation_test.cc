// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/point_observation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "perception/odometry/se3.h"

namespace prospect::point_observation_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

class PointObservationTest : public testing::Test {
 protected:
  std::mt19937_64 rng_{5};
  StereoCamera camera_;
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }

  Isometry3d motion(double translation, double rotation) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = uniform(-1, 1) * (i < 3 ? translation : rotation);
    return exp_se3(xi);
  }
};

TEST_F(PointObservationTest, JacobiansAgreeWithDifferences) {
  int checked = 0;
  for (int n = 0; n < 300; ++n) {
    const Isometry3d T = motion(0.5, 0.5);
    PointObservation o;
    o.T_WA = motion(0.5, 0.3);
    o.measured << uniform(100, 540), uniform(100, 380), uniform(8, 60);
    o.left = {300, 200};
    if (n % 2) o.right = 250;
    ObservationResidual at, plus, minus;
    if (!observation_residual(camera_, T, o, o.measured, at)) continue;
    if (at.d_pose.norm() > 1e5) continue;  // all but in the camera's plane
    ++checked;
    for (int i = 0; i < 6; ++i) {
      const double h = 1e-6;
      const Vector6d e = h * Vector6d::Unit(i);
      ASSERT_TRUE(observation_residual(camera_, exp_se3(e) * T, o, o.measured, plus));
      ASSERT_TRUE(observation_residual(camera_, exp_se3(-e) * T, o, o.measured, minus));
      EXPECT_LE((at.d_pose.col(i) - (plus.r - minus.r) / (2 * h)).norm(),
                1e-5 * (1 + at.d_pose.norm()));
    }
    for (int i = 0; i < 3; ++i) {
      const double h = 1e-4;
      const Vector3d e = h * Vector3d::Unit(i);
      ASSERT_TRUE(observation_residual(camera_, T, o, o.measured + e, plus));
      ASSERT_TRUE(observation_residual(camera_, T, o, o.measured - e, minus));
      EXPECT_LE((at.d_measured.col(i) - (plus.r - minus.r) / (2 * h)).norm(),
                1e-5 * (1 + at.d_measured.norm()));
    }
    if (n % 2 == 0) {
      EXPECT_EQ(at.d_pose.row(2).norm(), 0.0);
    }
  }
  EXPECT_GT(checked, 150);
  PointObservation behind;
  behind.T_WA.translation().z() = -3.0;
  behind.measured << 320, 240, camera_.left.fx * camera_.baseline / 2.0;
  ObservationResidual out;
  EXPECT_FALSE(observation_residual(camera_, Isometry3d::Identity(), behind, behind.measured, out));
  behind.T_WA.translation().z() = 0.0;
  EXPECT_TRUE(observation_residual(camera_, Isometry3d::Identity(), behind, behind.measured, out));
  EXPECT_FALSE(observation_residual(camera_, Isometry3d::Identity(), behind, {320, 240, 0}, out));
}

}  // namespace
}  // namespace prospect::point_observation_test
