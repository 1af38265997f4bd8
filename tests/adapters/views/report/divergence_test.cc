// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/divergence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/adapters/synthetic_run.h"

namespace prospect::divergence_test {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Straight ahead at 1 m/s, a step each `period` seconds.
DrivenSteps straight(int steps, double period = 0.5) {
  DrivenSteps run;
  for (int k = 0; k < steps; ++k) {
    const double t = k * period;
    run.time.push_back(t);
    run.mode.push_back("explore");
    for (auto* zero : {&run.vy, &run.omega, &run.y, &run.yaw}) zero->push_back(0.0);
    run.target_x.push_back(9.0);
    run.target_y.push_back(kNone);
    run.v.push_back(1.0);
    run.x.push_back(t);
  }
  return run;
}

TEST(Divergence, EqualRunsDoNotPart) {
  const Divergence none = first_divergence(straight(9), straight(9));
  EXPECT_EQ(none.step, -1);
  EXPECT_EQ(none.time, Divergence::kNever);
  EXPECT_EQ(none.apart, Divergence::kNever);
  // Nor does one that ends before, or that rounds otherwise.
  EXPECT_EQ(first_divergence(straight(9), straight(5)).step, -1);
  EXPECT_EQ(first_divergence(straight(5), straight(9)).step, -1);
  DrivenSteps rounded = straight(9);
  rounded.v[3] += 1e-9;
  rounded.x[4] += 1e-9;
  rounded.yaw[5] += 2.0 * M_PI;
  EXPECT_EQ(first_divergence(straight(9), rounded).step, -1);
  EXPECT_EQ(first_divergence({}, straight(3)).step, -1);
  EXPECT_EQ(first_divergence(straight(3), {}).step, -1);
}

TEST(Divergence, IsTheFirstOfWhatDiffers) {
  DrivenSteps other = straight(9);
  other.x[5] += 0.6;
  EXPECT_EQ(first_divergence(straight(9), other).step, 5);
  EXPECT_EQ(first_divergence(straight(9), other).what, "position: (2.50, 0.00), (3.10, 0.00)");
  EXPECT_EQ(first_divergence(straight(9), other).apart, 2.5);
  other.omega[4] = 0.25;
  EXPECT_EQ(first_divergence(straight(9), other).what,
            "command: 1.000 m/s 0.000 rad/s, 1.000 m/s 0.250 rad/s");
  other.target_x[3] = kNone;
  EXPECT_EQ(first_divergence(straight(9), other).step, 3);
  EXPECT_EQ(first_divergence(straight(9), other).what.substr(0, 8), "target: ");
  other.mode[3] = "retreat";
  const Divergence both = first_divergence(straight(9), other);
  EXPECT_EQ(both.what, "mode: explore, retreat");
  EXPECT_EQ(both.time, 1.5);
  EXPECT_EQ(both.apart, 2.5);
}

// What plans half as often is compared where it plans; in between its last step counts.
TEST(Divergence, StepsAreMatchedByTheirTime) {
  DrivenSteps often = straight(17, 0.25);
  const Divergence found = first_divergence(straight(9), often);
  EXPECT_EQ(found.step, -1);
  often.v[9] = 0.5;  // 2.25 s, between steps of the other
  EXPECT_EQ(first_divergence(straight(9), often).step, -1);
  often.v[12] = 0.5;  // 3 s
  EXPECT_EQ(first_divergence(straight(9), often).step, 6);
}

TEST(Divergence, StepsOfARecordAreThoseOfItsTable) {
  const RunRecord run = synthetic_run(60);
  const DrivenSteps steps = driven_steps(run.steps);
  ASSERT_EQ(steps.time.size(), 60U);
  EXPECT_EQ(steps.x[30], run.steps[30].estimated_pose.position.x());
  EXPECT_EQ(steps.omega[30], run.steps[30].command.yaw_rate);
  EXPECT_TRUE(std::isnan(steps.target_x[0]));  // it looks around
  EXPECT_EQ(first_divergence(steps, steps).step, -1);
  // A program of before told neither modes nor targets.
  const DrivenSteps old = driven_steps(StepTable::parse(
      "step,time,estimated_x,estimated_y,estimated_yaw\n0,0,1,2,3\n1,0.5,1.5,2,3\n", "steps.csv"));
  EXPECT_EQ(old.mode, (std::vector<std::string>{"", ""}));
  EXPECT_TRUE(std::isnan(old.v[1]));
  EXPECT_EQ(old.x[1], 1.5);
}

}  // namespace
}  // namespace prospect::divergence_test
