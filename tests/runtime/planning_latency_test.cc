// SPDX-License-Identifier: Apache-2.0
#include "runtime/planning_latency.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prospect::planning_latency_test {
namespace {

TEST(PlanningLatency, IsTheLongestOfTheLastStepsAndSlack) {
  PlanningLatency latency(0.05, 0.5, 0.1);
  EXPECT_EQ(latency.value(), 0.05);
  latency.add(0.2);
  EXPECT_NEAR(latency.value(), 0.3, 1e-12);
  latency.add(std::nan(""));
  for (int k = 0; k < 19; ++k) latency.add(0.03);
  EXPECT_NEAR(latency.value(), 0.3, 1e-12);
  latency.add(0.03);
  EXPECT_NEAR(latency.value(), 0.13, 1e-12);
}

TEST(PlanningLatency, StaysWithinItsBounds) {
  PlanningLatency latency(0.05, 0.5, 0.0);
  latency.add(0.01);
  EXPECT_EQ(latency.value(), 0.05);
  latency.add(3.0);
  EXPECT_EQ(latency.value(), 0.5);
}

}  // namespace
}  // namespace prospect::planning_latency_test
