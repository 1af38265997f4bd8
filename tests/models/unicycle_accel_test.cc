// SPDX-License-Identifier: Apache-2.0
#include "models/unicycle_accel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace prospect::unicycle_accel_test {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;

Vector5d vector5(double px, double py, double theta, double v, double omega) {
  Vector5d x;
  x << px, py, theta, v, omega;
  return x;
}

/// The exact motion: Simpson's rule on the Fresnel integrals, 2000 intervals (error below 1e-14
/// here).
Vector5d exact(const Vector5d& x, const Eigen::Vector2d& u, double dt) {
  const int n = 2000;
  Eigen::Vector2d way = Eigen::Vector2d::Zero();
  for (int i = 0; i <= n; ++i) {
    const double t = dt * i / n, weight = i == 0 || i == n ? 1.0 : (i % 2 ? 4.0 : 2.0);
    const double speed = x[3] + u[0] * t;
    const double theta = x[2] + x[4] * t + 0.5 * u[1] * t * t;
    way += weight * speed * Eigen::Vector2d(std::cos(theta), std::sin(theta));
  }
  Vector5d next;
  next << x.head<2>() + way * dt / (3.0 * n), x[2] + x[4] * dt + 0.5 * u[1] * dt * dt,
      x[3] + u[0] * dt, x[4] + u[1] * dt;
  return next;
}

class Fresnel : public testing::Test {
 protected:
  UnicycleAccel model_;
  std::mt19937_64 rng_{7};
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }
  Vector5d state() {
    Vector5d x;
    x << 0.0, 0.0, uniform(-4.0, 4.0), uniform(0.0, 0.6), uniform(-1.0, 1.0);
    return x;
  }
  Eigen::Vector2d input() { return {uniform(-0.8, 0.8), uniform(-2.5, 2.5)}; }
  Vector5d step(const Vector5d& x, const Eigen::Vector2d& u, double dt) const {
    Eigen::VectorXd next(5);
    model_.step(x, u, dt, next);
    return next;
  }
};

TEST_F(Fresnel, PositionErrorIsBelowTheDocumentedBoundAndTheRestIsExact) {
  double worst = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const Vector5d x = state();
    const Eigen::Vector2d u = input();
    const Vector5d error = step(x, u, 0.25) - exact(x, u, 0.25);
    worst = std::max(worst, error.head<2>().norm());
    ASSERT_LE(error.tail<3>().cwiseAbs().maxCoeff(), 1e-15 * 8);
  }
  EXPECT_LE(worst, 5e-5);
  RecordProperty("worst_position_error_m", std::to_string(worst));
}

TEST_F(Fresnel, PositionErrorFallsWithTheFifthPowerOfTheStep) {
  double coarse = 0.0, fine = 0.0;
  for (int n = 0; n < 500; ++n) {
    const Vector5d x = state();
    const Eigen::Vector2d u = input();
    coarse += (step(x, u, 0.2) - exact(x, u, 0.2)).head<2>().norm();
    fine += (step(x, u, 0.1) - exact(x, u, 0.1)).head<2>().norm();
  }
  EXPECT_GT(coarse / fine, 28.0);  // 2^5 = 32
  EXPECT_LT(coarse / fine, 36.0);
}

TEST_F(Fresnel, ArcsAndStraightLinesAreExact) {
  for (int n = 0; n < 500; ++n) {
    Vector5d x = state();
    const Vector5d arc = step(x, {0.0, 0.0}, 0.5) - exact(x, {0.0, 0.0}, 0.5);
    EXPECT_LE(arc.cwiseAbs().maxCoeff(), 1e-13);
    x[4] = 0.0;
    const Eigen::Vector2d straight(uniform(-0.8, 0.8), 0.0);
    EXPECT_LE((step(x, straight, 0.5) - exact(x, straight, 0.5)).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(UnicycleAccel, SpeedBoundsAreRowsOverTheState) {
  const UnicycleAccel model({.v_min = -0.2, .v_max = 0.5, .omega_max = 0.9});
  Eigen::VectorXd values(4);
  model.state_constraints(vector5(1.0, 2.0, 3.0, 0.6, -1.0), values, nullptr);
  EXPECT_NEAR(values[0], -0.1, 1e-15);
  EXPECT_NEAR(values[1], 0.8, 1e-15);
  EXPECT_NEAR(values[2], 1.9, 1e-15);
  EXPECT_NEAR(values[3], -0.1, 1e-15);
}

TEST(UnicycleAccel, BrakingStopsExactlyAndDoesNotReverse) {
  const UnicycleAccel model;
  const Eigen::VectorXd u =
      model.braking_input(vector5(0, 0, 0, 0.1, -0.1), Eigen::Vector2d::Zero(), 0.25);
  EXPECT_DOUBLE_EQ(u[0], -0.4);
  EXPECT_DOUBLE_EQ(u[1], 0.4);
  const Eigen::VectorXd hard =
      model.braking_input(vector5(0, 0, 0, 0.6, 1.0), Eigen::Vector2d::Zero(), 0.25);
  EXPECT_DOUBLE_EQ(hard[0], -0.8);
  EXPECT_DOUBLE_EQ(hard[1], -2.5);
}

}  // namespace
}  // namespace prospect::unicycle_accel_test
