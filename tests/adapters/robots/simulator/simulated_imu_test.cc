// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulated_imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "adapters/robots/simulator/kinematic_robot.h"

namespace prospect::simulated_imu_test {
namespace {

SimulatedImuOptions exact(double rate) {
  return {.rate = rate,
          .gyro_bias = 0.0,
          .gyro_noise = 0.0,
          .acceleration_bias = 0.0,
          .acceleration_noise = 0.0};
}

/// Along a constant twist, in pieces of a period, from rest.
std::vector<ImuSample> along(SimulatedImu& imu, const Twist& twist, double length, double period) {
  std::vector<ImuSample> all;
  Pose pose;
  for (int k = 0; k * period < length - 1e-9; ++k) {
    const Pose after = advance(pose, twist, period);
    for (const ImuSample& s : imu.moved(pose, k * period, after, (k + 1) * period)) {
      all.push_back(s);
    }
    pose = after;
  }
  return all;
}

TEST(SimulatedImu, MeasuresTurnAndForceOfAnArc) {
  SimulatedImu imu(exact(100.0), 1);
  const Twist twist{{0.4, 0.0, 0.0}, -0.8};
  const std::vector<ImuSample> samples = along(imu, twist, 10.0, 0.07);
  ASSERT_GE(samples.size(), 998u);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const ImuSample& s = samples[k];
    EXPECT_NEAR(s.stamp, 0.01 * static_cast<double>(k + 1), 1e-9);
    EXPECT_NEAR(s.yaw_rate(), -0.8, 1e-9) << "also where the heading goes through pi";
    // v w to the right, and gravity; at first the step of the speed from rest.
    EXPECT_NEAR(s.linear_acceleration.x(), k == 0 ? 40.0 : 0.0, 1e-6);
    EXPECT_NEAR(s.linear_acceleration.y(), -0.32, 1e-6);
    EXPECT_NEAR(s.linear_acceleration.z(), 9.81, 1e-12);
  }
}

TEST(SimulatedImu, ErrsByAConstantAndByNoise) {
  double squares = 0.0;
  constexpr int kImus = 200;
  for (int seed = 1; seed <= kImus; ++seed) {
    SimulatedImu imu({.rate = 100.0, .gyro_bias = 0.02, .gyro_noise = 0.005},
                     static_cast<std::uint64_t>(seed));
    const std::vector<ImuSample> samples = along(imu, {}, 4.0, 0.05);
    double mean = 0.0, spread = 0.0;
    for (const ImuSample& s : samples) mean += s.yaw_rate() / static_cast<double>(samples.size());
    for (const ImuSample& s : samples) spread += std::pow(s.yaw_rate() - mean, 2);
    EXPECT_NEAR(std::sqrt(spread / static_cast<double>(samples.size() - 1)), 0.005, 0.001);
    squares += mean * mean;
  }
  EXPECT_NEAR(std::sqrt(squares / kImus), 0.02, 0.004);
}

TEST(SimulatedImu, IsTheSameForTheSameSeedAndNoneWithoutARate) {
  SimulatedImu one({.rate = 50.0}, 7), same({.rate = 50.0}, 7), other({.rate = 50.0}, 8);
  const Twist twist{{0.3, 0.0, 0.0}, 0.2};
  const auto a = along(one, twist, 1.0, 0.1), b = along(same, twist, 1.0, 0.1),
             c = along(other, twist, 1.0, 0.1);
  ASSERT_EQ(a.size(), 50u);
  ASSERT_EQ(b.size(), 50u);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].angular_velocity, b[k].angular_velocity);
    EXPECT_NE(a[k].angular_velocity, c[k].angular_velocity);
  }
  SimulatedImu none({}, 1);
  EXPECT_TRUE(along(none, twist, 1.0, 0.1).empty());
}

}  // namespace
}  // namespace prospect::simulated_imu_test
