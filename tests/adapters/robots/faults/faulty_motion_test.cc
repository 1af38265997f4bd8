// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/faults/faulty_motion.h"

#include <gtest/gtest.h>

#include <string>

namespace prospect::faulty_motion_test {
namespace {

constexpr double kSpeed = 0.5, kRate = 0.4;  // [m/s], [rad/s]

TEST(FaultyMotion, IsOtherThanToldWhileTheFaultHolds) {
  struct Case {
    const char* verb;
    double speed, rate;
  };
  for (const Case& c :
       {Case{"inverted", -kSpeed, kRate}, Case{"mirrored", kSpeed, -kRate},
        Case{"double", 2.0 * kSpeed, 2.0 * kRate}, Case{"ignores", 0.0, 0.0},
        Case{"runaway", kSpeed + kRunaway, kRate},
        Case{"one-wheel", 0.5 * (kSpeed + 0.15 * kRate), (kSpeed + 0.15 * kRate) / kFaultyTrack}}) {
    FaultyMotion motion({parse_fault("base:" + std::string(c.verb) + "@5+2")});
    const Twist told{{kSpeed, 0.0, 0.0}, kRate};
    for (const double time : {4.9, 5.0, 6.9, 7.0}) {
      const Twist made = motion.made_of(told, time);
      const bool holds = time >= 5.0 && time < 7.0;
      EXPECT_DOUBLE_EQ(made.linear.x(), holds ? c.speed : kSpeed) << c.verb << " at " << time;
      EXPECT_DOUBLE_EQ(made.yaw_rate, holds ? c.rate : kRate) << c.verb << " at " << time;
    }
  }
}

TEST(FaultyMotion, WhatRunsAwayDoesSoOnceItWasToldToMoveUntilItIsStopped) {
  FaultyMotion motion({parse_fault("base:runaway")});
  EXPECT_EQ(motion.made_of({}, 1.0).linear.x(), 0.0);
  motion.made_of({{kSpeed, 0.0, 0.0}, 0.0}, 1.1);
  EXPECT_EQ(motion.made_of({}, 1.2).linear.x(), kRunaway);
  motion.stop();
  EXPECT_EQ(motion.made_of({}, 1.3).linear.x(), 0.0);
}

}  // namespace
}  // namespace prospect::faulty_motion_test
