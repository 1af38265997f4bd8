// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/command_gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace prospect::command_gate_test {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> kOne = {"/prospect"}, kTwo = {"/prospect", "/teleop"};
constexpr CommandGate::Limits kLimits{0.6, 1.2, 1.0, 2.0, 0.3, 0.02};

ros::Twist twist(double v, double w, double side = 0.0) {
  ros::Twist command;
  command.linear = {v, side, 0.0};
  command.angular.z = w;
  return command;
}
double speed(const ros::Twist& t) { return std::hypot(t.linear.x, t.linear.y, t.linear.z); }

/// The gate with commands again and again, until what goes out stays.
ros::Twist settled(CommandGate& gate, const ros::Twist& command, double& now) {
  ros::Twist out;
  for (int k = 0; k < 200; ++k) {
    now += 0.02;
    gate.take(command, 0.0, now);
    if (const auto sent = gate.output(kOne, now)) out = *sent;
  }
  return out;
}

TEST(CommandGate, NothingGoesOutBeforeTheFirstCommand) {
  CommandGate gate(kLimits);
  EXPECT_FALSE(gate.output(kOne, 5.0));
  EXPECT_FALSE(gate.output(kTwo, 5.0));
}

TEST(CommandGate, WhatIsWithinTheLimitsGoesOutAsItIs) {
  CommandGate gate(kLimits);
  double now = 10.0;
  gate.take(twist(0.0, 0.0), 0.0, now - 0.05);
  ASSERT_TRUE(gate.output(kOne, now - 0.05));
  for (int k = 1; k <= 12; ++k, now += 0.05) {  // 1 m/s^2, 2 rad/s^2
    const ros::Twist command = twist(0.05 * (k > 10 ? 20 - k : k) * 0.4, 0.1 * k);
    gate.take(command, 0.01, now);
    const auto out = gate.output(kOne, now);
    ASSERT_TRUE(out) << "each of them";
    EXPECT_NEAR(out->linear.x, command.linear.x, 1e-12) << k;
    EXPECT_NEAR(out->angular.z, command.angular.z, 1e-12) << k;
    EXPECT_FALSE(gate.output(kOne, now + 0.02)) << "nothing new to say";
  }
  EXPECT_EQ(gate.complaint(now), "");
}

TEST(CommandGate, BoundsVelocityAlongItsArc) {
  CommandGate gate(kLimits);
  double now = 0.0;
  for (const ros::Twist& command : {twist(50.0, 99.0), twist(50.0, 0.0), twist(0.1, -7.0),
                                    twist(-3.0, 1.0), twist(4.0, 0.0, -3.0)}) {
    const ros::Twist out = settled(gate, command, now);
    EXPECT_LE(speed(out), 0.6 + 1e-12);
    EXPECT_LE(std::abs(out.angular.z), 1.2 + 1e-12);
    EXPECT_NEAR(out.linear.x * command.angular.z, out.angular.z * command.linear.x, 1e-9);
    EXPECT_NEAR(out.linear.x * command.linear.y, out.linear.y * command.linear.x, 1e-9);
    EXPECT_GT(speed(out), 0.01);
    EXPECT_THAT(gate.complaint(now), HasSubstr("expected at most 0.6 m/s, 1.2 rad/s"));
  }
}

TEST(CommandGate, SpeedingUpIsBoundedAndBrakingIsNot) {
  // Whatever comes whenever: between two that go out the speed grows by at most a dt.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> velocity(-1.0, 1.0), pause(0.001, 0.2);
  CommandGate gate(kLimits);
  double now = 0.0, last_time = 0.0;
  ros::Twist last;
  for (int k = 0; k < 3000; ++k) {
    now += pause(random);
    if (k % 3 != 0) gate.take(twist(velocity(random), 2.0 * velocity(random)), 0.0, now);
    const auto out = gate.output(kOne, now);
    if (!out) continue;
    const double dt = last_time > 0.0 ? now - last_time : kLimits.period;
    EXPECT_LE(speed(*out) - speed(last), kLimits.acceleration * dt + 1e-9) << k;
    EXPECT_LE(std::abs(out->angular.z) - std::abs(last.angular.z),
              kLimits.yaw_acceleration * dt + 1e-9);
    if (out->linear.x * last.linear.x < 0.0) {
      EXPECT_LE(std::abs(out->linear.x), kLimits.acceleration * dt + 1e-9) << k;
    }
    last = *out;
    last_time = now;
  }
  settled(gate, twist(0.6, 1.2), now);
  gate.take(twist(0.1, 0.2), 0.0, now);
  EXPECT_NEAR(gate.output(kOne, now)->linear.x, 0.1, 1e-12) << "braking at once";
  gate.take(twist(0.0, 0.0), 0.0, now);
  EXPECT_EQ(gate.output(kOne, now)->linear.x, 0.0);
  EXPECT_EQ(gate.complaint(now), "");
  gate.take(twist(0.6, 0.0), 0.0, now + 0.05);
  EXPECT_NEAR(gate.output(kOne, now + 0.05)->linear.x, 0.05, 1e-9);
  EXPECT_THAT(gate.complaint(now + 0.05), HasSubstr("changes by more than 1 m/s^2, 2 rad/s^2"));
}

TEST(CommandGate, AgeCountsFromTheStamp) {
  CommandGate gate(kLimits);
  double now = 1.0;
  settled(gate, twist(0.3, 0.0), now);
  gate.take(twist(0.5, 0.0), 30.0, now);
  EXPECT_FALSE(gate.output(kOne, now)) << "it counts for nothing";
  EXPECT_THAT(gate.complaint(now), HasSubstr("stamped 30 s ago"));
  for (const double age :
       {0.3, -0.3, -30.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    gate.take(twist(0.5, 0.0), age, now);
    EXPECT_FALSE(gate.output(kOne, now)) << age;
  }
  gate.take(twist(0.3, 0.0), 0.2, now);
  EXPECT_NEAR(gate.output(kOne, now + 0.09)->linear.x, 0.3, 1e-12);
  EXPECT_EQ(gate.output(kOne, now + 0.101)->linear.x, 0.0) << "0.3 s after it was made";
  EXPECT_EQ(gate.output(kOne, now + 0.12)->linear.x, 0.0) << "again and again";
  now += 1.0;
  settled(gate, twist(0.3, 0.0), now);
  gate.take(twist(0.0, 0.0), 30.0, now);
  EXPECT_EQ(gate.output(kOne, now)->linear.x, 0.0) << "a stop is never too old";
}

TEST(CommandGate, WhatIsNoNumberIsAStop) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  for (const ros::Twist& bad :
       {twist(nan, 0.0), twist(0.1, infinite), twist(-infinite, infinite), twist(0.1, 0.1, nan)}) {
    CommandGate gate(kLimits);
    double now = 1.0;
    settled(gate, twist(0.3, 0.5), now);
    gate.take(bad, 0.0, now);
    const auto out = gate.output(kOne, now);
    ASSERT_TRUE(out);
    EXPECT_EQ(speed(*out), 0.0);
    EXPECT_EQ(out->angular.z, 0.0);
    EXPECT_THAT(gate.complaint(now), HasSubstr("not finite"));
  }
}

TEST(CommandGate, ASecondCommanderStopsItAndIsNamed) {
  CommandGate gate(kLimits);
  double now = 1.0;
  settled(gate, twist(0.3, 0.0), now);
  for (int k = 0; k < 10; ++k) {
    now += 0.02;
    gate.take(twist(k % 2 ? 0.3 : 0.5, 0.0), 0.0, now);
    const auto out = gate.output(kTwo, now);
    ASSERT_TRUE(out);
    EXPECT_EQ(speed(*out), 0.0);
    EXPECT_THAT(gate.complaint(now),
                HasSubstr("2 publishers of commands: /prospect, /teleop; expected one"));
  }
  EXPECT_EQ(speed(*gate.output(kOne, now + 0.02)), 0.0) << "what they said does not count later";
  gate.take(twist(0.3, 0.0), 0.0, now + 0.04);
  EXPECT_GT(speed(*gate.output(kOne, now + 0.04)), 0.0) << "the one that is left goes on";
  EXPECT_EQ(gate.complaint(now + 2.0), "");
}

TEST(CommandGate, ClosedItSendsZero) {
  CommandGate gate(kLimits);
  double now = 1.0;
  settled(gate, twist(0.3, 0.0), now);
  gate.close();
  gate.take(twist(0.3, 0.0), 0.0, now);
  EXPECT_EQ(speed(*gate.output(kOne, now)), 0.0);
}

}  // namespace
}  // namespace prospect::command_gate_test
