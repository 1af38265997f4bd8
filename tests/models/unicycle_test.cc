// SPDX-License-Identifier: Apache-2.0
#include "models/unicycle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace prospect::unicycle_test {
namespace {

Eigen::VectorXd step(const Unicycle& model, const Eigen::Vector3d& x, const Eigen::Vector2d& u,
                     double dt) {
  Eigen::VectorXd next(3);
  model.step(x, u, dt, next);
  return next;
}

TEST(Unicycle, DrivesQuarterAndFullCircles) {
  const Unicycle model;
  const double half_pi = std::numbers::pi / 2.0;
  // Radius v/omega = 2 m, to the left, from the origin along x: centre (0, 2).
  const Eigen::VectorXd quarter = step(model, {0, 0, 0}, {2.0, 1.0}, half_pi);
  EXPECT_NEAR(quarter[0], 2.0, 1e-14);
  EXPECT_NEAR(quarter[1], 2.0, 1e-14);
  EXPECT_NEAR(quarter[2], half_pi, 1e-15);
  const Eigen::VectorXd full = step(model, {1, 2, 3}, {2.0, 1.0}, 4.0 * half_pi);
  EXPECT_NEAR(full[0], 1.0, 1e-14);
  EXPECT_NEAR(full[1], 2.0, 1e-14);
  EXPECT_NEAR(full[2], 3.0 + 4.0 * half_pi, 1e-14);  // not wrapped
}

TEST(Unicycle, EqualsTheTextbookArcAwayFromZeroTurnRate) {
  const Unicycle model;
  for (double omega = -3.0; omega <= 3.0; omega += 0.0137) {
    if (std::abs(omega) < 0.01) continue;
    for (double theta = -4.0; theta <= 4.0; theta += 0.31) {
      const double v = 0.7, dt = 0.9;
      const Eigen::VectorXd next = step(model, {1.0, -2.0, theta}, {v, omega}, dt);
      EXPECT_NEAR(next[0], 1.0 + v / omega * (std::sin(theta + omega * dt) - std::sin(theta)),
                  2e-13);
      EXPECT_NEAR(next[1], -2.0 - v / omega * (std::cos(theta + omega * dt) - std::cos(theta)),
                  2e-13);
    }
  }
}

TEST(Unicycle, LimitsComeFromItsParameters) {
  const Unicycle model({.v_min = -0.1,
                        .v_max = 0.5,
                        .omega_max = 0.8,
                        .a_max = 0.4,
                        .alpha_max = 1.5,
                        .fixed_z = 0.7});
  EXPECT_EQ(model.limits().lower, Eigen::VectorXd(Eigen::Vector2d(-0.1, -0.8)));
  EXPECT_EQ(model.limits().upper, Eigen::VectorXd(Eigen::Vector2d(0.5, 0.8)));
  EXPECT_EQ(model.limits().rate, Eigen::VectorXd(Eigen::Vector2d(0.4, 1.5)));
  EXPECT_EQ(model.max_speed(), 0.5);
  EXPECT_EQ(model.max_yaw_rate(), 0.8);
  EXPECT_EQ(model.max_deceleration(), 0.4);
  EXPECT_EQ(model.pose(Eigen::Vector3d(1, 2, 3)).position, Eigen::Vector3d(1, 2, 0.7));
}

TEST(Unicycle, BrakingStepsDownAtTheRate) {
  const Unicycle model;
  const Eigen::VectorXd u =
      model.braking_input(Eigen::Vector3d::Zero(), Eigen::Vector2d(0.5, -0.1), 0.25);
  EXPECT_DOUBLE_EQ(u[0], 0.3);
  EXPECT_EQ(u[1], 0.0);
}

}  // namespace
}  // namespace prospect::unicycle_test
