// SPDX-License-Identifier: Apache-2.0
#include "models/holonomic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/unicycle.h"

namespace prospect::holonomic_test {
namespace {

/// exp of the twist's matrix in SE(2) by its power series: an independent closed form.
Eigen::Matrix3d exponential(const Eigen::Vector3d& twist, double dt) {
  Eigen::Matrix3d xi;
  xi << 0.0, -twist[2], twist[0], twist[2], 0.0, twist[1], 0.0, 0.0, 0.0;
  xi *= dt;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), term = sum;
  for (int n = 1; n < 40; ++n) {
    term = term * xi / n;
    sum += term;
  }
  return sum;
}

TEST(Holonomic, IsTheExponentialOfTheBodyTwist) {
  const Holonomic model;
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int n = 0; n < 1000; ++n) {
    const Eigen::Vector3d x(uniform(rng), uniform(rng), 4.0 * uniform(rng));
    const double omega = n % 2 ? 3.0 * uniform(rng) : std::pow(10.0, -6.0 + 6.0 * uniform(rng));
    const Eigen::Vector3d u(uniform(rng), uniform(rng), omega);
    const double dt = 0.5 + 0.4 * uniform(rng);
    Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
    T.topLeftCorner<2, 2>() << std::cos(x[2]), -std::sin(x[2]), std::sin(x[2]), std::cos(x[2]);
    T.topRightCorner<2, 1>() = x.head<2>();
    const Eigen::Matrix3d expected = T * exponential(u, dt);
    Eigen::VectorXd next(3);
    model.step(x, u, dt, next);
    EXPECT_NEAR(next[0], expected(0, 2), 1e-14);
    EXPECT_NEAR(next[1], expected(1, 2), 1e-14);
    EXPECT_NEAR(std::cos(next[2]), expected(0, 0), 1e-14);
    EXPECT_NEAR(std::sin(next[2]), expected(1, 0), 1e-14);
  }
}

TEST(Holonomic, WithoutSidewaysSpeedIsAUnicycle) {
  const Holonomic holonomic;
  const Unicycle unicycle;
  Eigen::VectorXd a(3), b(3);
  for (double omega = -2.0; omega <= 2.0; omega += 0.1) {
    holonomic.step(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0.5, 0.0, omega), 0.3, a);
    unicycle.step(Eigen::Vector3d(1, 2, 3), Eigen::Vector2d(0.5, omega), 0.3, b);
    EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1e-15);
  }
}

TEST(Holonomic, CanLookElsewhereThanItDrives) {
  const Holonomic model;
  Eigen::VectorXd next(3);
  model.step(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0.5, 0), 2.0, next);
  EXPECT_EQ(next, Eigen::VectorXd(Eigen::Vector3d(0, 1, 0)));
}

}  // namespace
}  // namespace prospect::holonomic_test
