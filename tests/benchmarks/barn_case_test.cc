// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/barn_case.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::barn_case_test {
namespace {

const Eigen::Vector2d kStart(-2.0, 3.0), kGoal(-2.0, 13.0);

TEST(BarnCase, TheMetricIsTheShareOfTheBestTime) {
  EXPECT_DOUBLE_EQ(barn_metric(10.0, 5.0), 0.25) << "quicker than four times the best: no more";
  EXPECT_DOUBLE_EQ(barn_metric(10.0, 20.0), 0.25);
  EXPECT_DOUBLE_EQ(barn_metric(10.0, 25.0), 0.2);
  EXPECT_DOUBLE_EQ(barn_metric(10.0, 90.0), 0.125);
  EXPECT_EQ(barn_metric(10.0, std::nullopt), 0.0);
}

TEST(BarnCase, TimeCountsFromTheFirstTenCentimetresToAMetreFromTheGoal) {
  const std::vector<TimedPlace> straight = {{0.0, kStart}, {5.0, kStart}, {15.0, kGoal}};
  EXPECT_NEAR(barn_time(straight, kGoal).value(), 8.9, 1e-9);
  EXPECT_FALSE(barn_time({{0.0, kStart}, {9.0, {-2.0, 11.9}}}, kGoal));
  EXPECT_FALSE(barn_time({{0.0, kStart}, {9.0, kStart}}, kGoal));
  EXPECT_FALSE(barn_time({}, kGoal));
}

TEST(BarnCase, APathThatIsNoneIsRefused) {
  const std::string file = ::testing::TempDir() + "/barn_path.npy";
  for (const std::string& bytes :
       {std::string(), std::string("\x93NUMPY\x01\x00", 8), std::string(200, 'x'),
        std::string("\x93NUMPY\x01\x00\x02\x00{}", 12)}) {
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_THROW(barn_path_length(file, kStart, kGoal), InputError);
  }
  std::filesystem::remove(file);
  EXPECT_THROW(barn_path_length(file, kStart, kGoal), InputError);
}

TEST(BarnCase, ReachesTheGoalOfAWorldOfBarnAndTouchesNothing) {
  NOT_UNDER_SANITIZERS("a mission of a bulky body goes the ways of shorter tests");
  const std::string folder = std::string(PROSPECT_SHARED_DATA) + "/barn/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no worlds of BARN here";
  EXPECT_NEAR(barn_path_length(folder + "path_0.npy", kStart, kGoal), 13.43, 0.01);
  const Configuration configuration =
      read_configuration(std::string(PROSPECT_SOURCE_DIR) + "/benchmarks/barn.yaml");
  const BarnOutcome outcome =
      drive_barn(folder + "world_30.world", folder + "path_30.npy", configuration, false);
  EXPECT_EQ(outcome.contacts, 0);
  EXPECT_EQ(outcome.end, MissionEnd::kGoalReached);
  EXPECT_GT(outcome.metric, 0.2);
}

}  // namespace
}  // namespace prospect::barn_case_test
