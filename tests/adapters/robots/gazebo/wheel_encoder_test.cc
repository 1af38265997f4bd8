// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/wheel_encoder.h"

#include <gtest/gtest.h>

#include <numbers>
#include <optional>

namespace prospect::wheel_encoder_test {
namespace {

/// Wheels that have turned by these angles, mounted with their own axes turned, on a body that lies
/// anywhere.
GazeboPoses turned_by(double stamp, double left, double right) {
  const Eigen::Quaterniond mount(
      Eigen::AngleAxisd(-std::numbers::pi / 2.0, Eigen::Vector3d::UnitX()));
  const auto wheel = [&](double angle) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())) * mount;
  };
  GazeboPoses poses;
  poses.stamp = stamp;
  poses.poses = {{"robot", {3.0 * stamp, 0.0, 0.0}, Eigen::Quaterniond::Identity()},
                 {"robot::left_wheel", {0.0, 0.16, 0.0}, wheel(left)},
                 {"robot::right_wheel", {0.0, -0.16, 0.0}, wheel(right)}};
  return poses;
}

TEST(WheelEncoder, MeasuresWhatWheelsTurn) {
  WheelEncoder encoder({});  // radius 0.08, separation 0.32
  EXPECT_EQ(encoder.add(turned_by(1.0, 3.0, -3.0)), std::nullopt);
  const auto ahead = encoder.add(turned_by(1.1, 3.5, -2.5));
  ASSERT_TRUE(ahead);
  EXPECT_EQ(ahead->stamp, 1.1);
  EXPECT_NEAR(ahead->velocity.x(), 0.4, 1e-9);
  EXPECT_NEAR(ahead->yaw_rate, 0.0, 1e-9);
  const auto turn = encoder.add(turned_by(1.2, 3.5, -2.3));
  ASSERT_TRUE(turn);
  EXPECT_NEAR(turn->velocity.x(), 0.08, 1e-9);
  EXPECT_NEAR(turn->yaw_rate, 0.5, 1e-9);
  const auto back = encoder.add(turned_by(1.3, 3.3, -2.5));
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->velocity.x(), -0.16, 1e-9);
}

TEST(WheelEncoder, LeavesOutWhatSaysNothing) {
  WheelEncoder encoder({});
  EXPECT_EQ(encoder.add(turned_by(1.0, 0.0, 0.0)), std::nullopt);
  EXPECT_EQ(encoder.add(turned_by(1.0, 0.5, 0.5)), std::nullopt);
  GazeboPoses bare = turned_by(1.1, 0.0, 0.0);
  bare.poses.pop_back();
  EXPECT_EQ(encoder.add(bare), std::nullopt);
  ASSERT_TRUE(encoder.add(turned_by(1.1, 0.0, 0.0)));
  // The simulation was reset.
  EXPECT_EQ(encoder.add(turned_by(0.2, 1.0, 1.0)), std::nullopt);
  const auto on = encoder.add(turned_by(0.3, 1.0, 1.0));
  ASSERT_TRUE(on);
  EXPECT_NEAR(on->velocity.x(), 0.0, 1e-9);
}

}  // namespace
}  // namespace prospect::wheel_encoder_test
