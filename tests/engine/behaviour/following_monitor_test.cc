// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/following_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace prospect::following_monitor_test {
namespace {

constexpr double kDt = 0.5;

Twist ahead(double v, double omega = 0.0) { return {Eigen::Vector3d(v, 0.0, 0.0), omega}; }

TEST(FollowingMonitor, ARobotThatDoesNotMoveIsBlockedInTheDirectionOfItsCommands) {
  FollowingMonitor motion;
  const Pose pose{{2.0, -1.0, 0.0}, M_PI / 2.0};
  int noticed = 0;
  for (int n = 0; n < 12; ++n) {
    const auto direction = motion.update(kDt * n, pose, ahead(0.2, 0.9));
    if (!direction) continue;
    ++noticed;
    EXPECT_NEAR((*direction - Eigen::Vector2d::UnitY()).norm(), 0.0, 1e-12);
    EXPECT_EQ(n % 3, 0) << "0.3 m at 0.2 m/s";
  }
  EXPECT_EQ(noticed, 3);
}

TEST(FollowingMonitor, WhoFollowsItsCommandsIsNot) {
  // Straight on, on circles of 20 and 2 cm, to and fro, and slipping by half.
  struct Case {
    double v, omega, slip;
    bool reverses;
  };
  for (const Case& c :
       {Case{0.5, 0.0, 1.0, false}, Case{0.2, 1.0, 1.0, false}, Case{0.02, 1.0, 1.0, false},
        Case{0.1, 0.0, 1.0, true}, Case{0.5, 0.0, 0.5, false}, Case{0.0, 1.0, 1.0, false}}) {
    FollowingMonitor motion;
    Pose pose;
    double t = 0.0;
    for (int n = 0; n < 400; ++n) {
      const double v = c.reverses && n % 8 >= 4 ? -c.v : c.v;
      EXPECT_FALSE(motion.update(t, pose, ahead(v, c.omega))) << c.v << ' ' << c.omega << ' ' << n;
      const double dt = 0.1;
      t += dt;
      const double yaw = pose.yaw + 0.5 * dt * c.omega;
      pose.position += c.slip * v * dt * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
      pose.yaw += dt * c.omega;
    }
  }
}

TEST(FollowingMonitor, HeightHasNoPartInIt) {
  FollowingMonitor motion;
  for (int n = 0; n < 12; ++n) {
    EXPECT_FALSE(motion.update(kDt * n, {}, {Eigen::Vector3d(0.0, 0.0, 0.5), 0.0})) << n;
  }
}

TEST(FollowingMonitor, BeginsAnewAfterAGapAndWhatIsNotFinite) {
  const Pose pose;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  FollowingMonitor motion;
  // Two steps of half a second are never 0.3 m at 0.2 m/s.
  double t = 0.0;
  for (int n = 0; n < 12; ++n) {
    t += n % 3 == 0 ? FollowingMonitor::kLongest + 0.1 : kDt;
    EXPECT_FALSE(motion.update(t, pose, ahead(0.2))) << n;
  }
  motion.reset();
  for (int n = 0; n < 12; ++n) {
    t += kDt;
    EXPECT_FALSE(motion.update(t, pose, ahead(n % 3 == 2 ? nan : 0.2))) << n;
  }
  const Pose nowhere{{nan, 0.0, 0.0}, 0.0}, unturned{{0.0, 0.0, 0.0}, nan};
  for (const Pose& bad : {nowhere, unturned}) {
    motion.reset();
    for (int n = 0; n < 12; ++n) {
      t += kDt;
      EXPECT_FALSE(motion.update(t, n % 3 == 2 ? bad : pose, ahead(0.2))) << n;
    }
  }
  motion.reset();
  for (int n = 0; n < 12; ++n) {
    t += kDt;
    EXPECT_FALSE(motion.update(n % 3 == 2 ? nan : t, pose, ahead(0.2))) << n;
  }
  for (int n = 0; n < 12; ++n) {
    t += kDt;
    if (n % 3 == 2) motion.reset();
    EXPECT_FALSE(motion.update(t, pose, ahead(0.2))) << n;
  }
  t -= 100.0;
  EXPECT_FALSE(motion.update(t, pose, ahead(0.2))) << "a clock that jumps back";
}

}  // namespace
}  // namespace prospect::following_monitor_test
