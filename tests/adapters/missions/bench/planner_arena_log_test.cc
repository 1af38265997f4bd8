// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/planner_arena_log.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "tests/adapters/bench_example.h"

namespace prospect::planner_arena_log_test {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Reads the log as the reader of the format does: counts say how many lines follow.
TEST(PlannerArenaLog, HasAsManyLinesAsItsCountsSay) {
  const BenchTable table = test::bench_example(5, 1.0, {1, 2});
  const auto lines = lines_of(planner_arena_log(table, 0, 0.0));
  std::size_t at = 0;
  const auto count_of = [&](const std::string& what) {
    EXPECT_NE(lines.at(at).find(what), std::string::npos) << lines.at(at) << ": " << what;
    return std::stoul(lines.at(at++));
  };
  EXPECT_EQ(lines.at(at++), "OMPL version 1.5.2");
  EXPECT_EQ(lines.at(at++), "Experiment set");
  at += count_of("experiment properties");
  EXPECT_EQ(lines.at(at++), "Running on prospect");
  EXPECT_EQ(lines.at(at++).rfind("Starting at ", 0), 0U);
  for (int block = 0; block < 2; ++block) {
    EXPECT_EQ(lines.at(at++), "<<<|");
    while (lines.at(at++) != "|>>>") {
    }
  }
  EXPECT_EQ(count_of("is the random seed"), 1U);
  count_of("seconds per run");
  count_of("MB per run");
  EXPECT_EQ(count_of("runs per planner"), 10U);
  count_of("seconds spent to collect the data");
  EXPECT_EQ(count_of("enum type"), 1U);
  EXPECT_EQ(lines.at(at++).rfind("status|converged|", 0), 0U);
  const std::size_t planners = count_of("planners");
  ASSERT_EQ(planners, 2U);
  for (std::size_t k = 0; k < planners; ++k) {
    EXPECT_EQ(lines.at(at++), table.solvers[k]);
    EXPECT_EQ(count_of("common properties"), 0U);
    const std::size_t properties = count_of("properties for each run");
    at += properties;
    const std::size_t runs = count_of("runs");
    EXPECT_EQ(runs, 10U);
    for (std::size_t r = 0; r < runs; ++r) {
      const std::string& run = lines.at(at++);
      EXPECT_EQ(std::count(run.begin(), run.end(), ';'), static_cast<long>(properties)) << run;
    }
    EXPECT_EQ(count_of("progress properties for each run"), 3U);
    at += 3;
    EXPECT_EQ(count_of("runs"), 10U);
    for (std::size_t r = 0; r < runs; ++r) {
      const std::string& run = lines.at(at++);
      EXPECT_EQ(std::count(run.begin(), run.end(), ';'), 2) << run;  // two improvements
      EXPECT_EQ(std::count(run.begin(), run.end(), ','), 6) << run;
    }
    EXPECT_EQ(lines.at(at++), ".");
  }
  EXPECT_EQ(at, lines.size());
}

TEST(PlannerArenaLog, LeavesEmptyWhatThereIsNot) {
  const std::string log = planner_arena_log(test::bench_example(1), 0, 0.0);
  // "slow" does not solve the problem: no time and no evaluations to target.
  EXPECT_NE(log.find("\n0; 1; 0; 0; 0.1; ; 1.5; 0.5; 1e-04; 200; ; 200; \n"), std::string::npos)
      << log;
}

}  // namespace
}  // namespace prospect::planner_arena_log_test
