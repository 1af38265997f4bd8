// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/se3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace prospect::se3_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

class Se3 : public testing::Test {
 protected:
  std::mt19937_64 rng_{5};
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }

  Isometry3d motion(double translation, double rotation) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = uniform(-1, 1) * (i < 3 ? translation : rotation);
    return exp_se3(xi);
  }
};

TEST_F(Se3, ExponentialAndLogarithmAreInverse) {
  for (int n = 0; n < 200; ++n) {
    const double size = std::pow(10.0, uniform(-9, 0.3));
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = uniform(-1, 1) * size;
    const Isometry3d T = exp_se3(xi);
    EXPECT_LE((log_se3(T) - xi).norm(), 1e-9 * (1.0 + xi.norm()) + 1e-7 * xi.norm());
    EXPECT_LE((T.linear() * T.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  }
  // A screw about z: half a turn on a circle of diameter 2/pi along x.
  Vector6d half;
  half << 1, 0, 0, 0, 0, M_PI;
  EXPECT_LE((exp_se3(half).translation() - Vector3d(0, 2.0 / M_PI, 0)).norm(), 1e-12);
}

TEST_F(Se3, TheAdjointCarriesAStepOver) {
  for (int n = 0; n < 200; ++n) {
    const Isometry3d T = motion(2.0, 1.5);
    const Vector6d xi = log_se3(motion(0.5, 0.5));
    const Isometry3d carried = exp_se3(adjoint(T) * xi);
    EXPECT_LE((carried.matrix() - (T * exp_se3(xi) * T.inverse()).matrix()).norm(), 1e-12);
  }
}

TEST_F(Se3, SkewIsTheCrossProduct) {
  const Vector3d a(1.0, -2.0, 3.0), b(0.5, 4.0, -1.5);
  EXPECT_EQ(skew(a) * b, a.cross(b));
}

}  // namespace
}  // namespace prospect::se3_test
