// SPDX-License-Identifier: Apache-2.0
#include "runtime/gyro_rate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace prospect::gyro_rate_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Its acceleration is another one each time, as that of any sensor.
ImuSample turning(double stamp, double rate) {
  ImuSample sample;
  sample.stamp = stamp;
  sample.angular_velocity.z() = rate;
  sample.linear_acceleration = {0.0, 1e-3 * std::sin(1e3 * stamp), 9.8};
  return sample;
}

/// Five samples that end at a time.
std::vector<ImuSample> look_at(double end, double rate) {
  std::vector<ImuSample> samples;
  for (int k = 4; k >= 0; --k) samples.push_back(turning(end - 0.01 * k, rate));
  return samples;
}

TEST(GyroRate, IsTheMedianOfALookLessTheBias) {
  GyroRate gyro(0.1);
  EXPECT_FALSE(gyro.look(look_at(1.0, 0.3))) << "since when nobody knows";
  std::vector<ImuSample> samples = look_at(1.05, 0.3);
  samples[1].angular_velocity.z() = 1e9;
  samples[3].angular_velocity.z() = kNan;
  const auto turn = gyro.look(samples);
  ASSERT_TRUE(turn);
  EXPECT_DOUBLE_EQ(turn->from, 1.0);
  EXPECT_DOUBLE_EQ(turn->until, 1.05);
  EXPECT_DOUBLE_EQ(turn->rate, 0.3);
  EXPECT_FALSE(gyro.look(look_at(1.05, 0.7))) << "it is not newer";
  EXPECT_FALSE(gyro.look({}));
  EXPECT_FALSE(gyro.look(look_at(2.0, 0.3))) << "of what was between nothing is known";
  EXPECT_TRUE(gyro.look(look_at(2.05, 0.3)));
}

TEST(GyroRate, LearnsItsBiasWhileTheRobotStands) {
  GyroRate gyro(0.1);
  double now = 0.0;
  const auto stand = [&](double seconds, double rate) {
    for (const double end = now + seconds; now < end - 1e-9; now += 0.05) {
      if (const auto turn = gyro.look(look_at(now, rate))) gyro.stood(*turn);
    }
  };
  stand(0.4, 0.06);
  EXPECT_FALSE(gyro.knows_bias());
  stand(0.4, 0.06);
  EXPECT_TRUE(gyro.knows_bias());
  EXPECT_NEAR(gyro.look(look_at(now, 0.06))->rate, 0.0, 1e-12);
  now += 0.05;
  // It drifts; and what is more than a bias is a turn.
  stand(10.0, -0.03);
  EXPECT_NEAR(gyro.look(look_at(now, -0.03))->rate, 0.0, 1e-3);
  now += 0.05;
  stand(10.0, 0.3);
  EXPECT_NEAR(gyro.look(look_at(now, 0.3))->rate, 0.33, 1e-3);
}

TEST(GyroRate, ASensorThatHangsMeasuresNothing) {
  GyroRate gyro(0.1);
  gyro.look(look_at(1.0, 0.3));
  ImuSample same = turning(1.0, 0.3);
  for (double now = 1.05; now < 1.2; now += 0.05) {
    same.stamp = now;
    EXPECT_FALSE(gyro.look(std::vector{same})) << now;
  }
  EXPECT_EQ(gyro.stamp(), 1.0);
}

TEST(GyroRate, IsOfTheBodysAxes) {
  GyroRate gyro(0.1);
  // Mounted with its x axis upwards.
  const auto mounted = [](double stamp) {
    ImuSample sample = turning(stamp, 0.0);
    sample.angular_velocity = {0.4, 0.0, 0.0};
    sample.R_BS = Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitY());
    return sample;
  };
  gyro.look(std::vector{mounted(1.0)});
  const auto turn = gyro.look(std::vector{mounted(1.01)});
  ASSERT_TRUE(turn);
  EXPECT_NEAR(turn->rate, 0.4, 1e-12);
}

}  // namespace
}  // namespace prospect::gyro_rate_test
