// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/motion_prior.h"

#include <gtest/gtest.h>

namespace prospect::motion_prior_test {
namespace {

using Vector6d = MotionPrior::Vector6d;

/// A change by an acceleration along x [m/s^2] over dt.
Vector6d accelerated(double acceleration, double dt) {
  return acceleration * dt * dt * Vector6d::Unit(0);
}

TEST(MotionPrior, NothingIsLikelierThanGoingOn) {
  const MotionPrior prior;
  EXPECT_EQ(prior.log_likelihood(Vector6d::Zero(), 0.1), 0.0);
  double before = 0.0;
  for (double a : {1.0, 3.0, 10.0, 30.0, 100.0}) {
    const double now = prior.log_likelihood(accelerated(a, 0.1), 0.1);
    EXPECT_LT(now, before) << a;
    before = now;
  }
  // A turn by itself is judged as a turn.
  EXPECT_LT(prior.log_likelihood(0.5 * Vector6d::Unit(4), 0.1), -2.0);
}

TEST(MotionPrior, IsOfAccelerations) {
  // The same acceleration over another time is as likely, but for the noise of a pose.
  const MotionPrior prior;
  EXPECT_NEAR(prior.log_likelihood(accelerated(9.0, 0.2), 0.2),
              prior.log_likelihood(accelerated(9.0, 0.1), 0.1), 0.1);
}

TEST(MotionPrior, LearnsHowTheCameraMoves) {
  MotionPrior smooth, shaken;
  for (int k = 0; k < 40; ++k) {
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    smooth.add(accelerated(0.3 * sign, 0.1), 0.1);
    shaken.add(accelerated(10.0 * sign, 0.1), 0.1);
  }
  const Vector6d jump = accelerated(8.0, 0.1);
  EXPECT_LT(smooth.log_likelihood(jump, 0.1), -8.0);
  EXPECT_GT(shaken.log_likelihood(jump, 0.1), -3.0);
  // It may jump all the same: a Gaussian of this level would say -1000 and less.
  EXPECT_GT(smooth.log_likelihood(accelerated(60.0, 0.1), 0.1), -100.0);
  // And is believed soon.
  for (int k = 0; k < 20; ++k) smooth.add(jump, 0.1);
  EXPECT_GT(smooth.log_likelihood(jump, 0.1), -4.0);
}

}  // namespace
}  // namespace prospect::motion_prior_test
