// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/replay/recorded_run.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace prospect::recorded_run_test {
namespace {

RecordedRun recorded() {
  RecordedRun run;
  run.header = "step,cost,why";
  run.rows = {"0,1.5,\"a, b\"", "1,2.5,c"};
  return run;
}

TEST(RecordedRun, WhatALaterVersionTellsBesideIsNoDifference) {
  const std::string header = "step,frontiers,cost,why,more";
  const std::vector<std::string> rows = {"0,\"x, y\",1.5,\"a, b\",7", "1,,2.5,c,"};
  EXPECT_EQ(first_difference(recorded(), header, rows).step, -1);
  const RunDifference d = first_difference(recorded(), header, {rows[0], "1,,2.4,c,"});
  EXPECT_EQ(d.step, 1);
  EXPECT_EQ(d.what, "cost: 2.5 recorded, 2.4 now");
}

TEST(RecordedRun, AColumnThatIsGoneIsADifference) {
  const RunDifference d = first_difference(recorded(), "step,why", {"0,\"a, b\"", "1,c"});
  EXPECT_EQ(d.step, 0);
  EXPECT_EQ(d.what, "its columns: cost: cost recorded, why now");
}

}  // namespace
}  // namespace prospect::recorded_run_test
