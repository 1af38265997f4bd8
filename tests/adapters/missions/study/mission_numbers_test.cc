// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/mission_numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/run/summary.h"

namespace prospect::mission_numbers_test {
namespace {

StepRecord step(double time, double coverage, double error, double predicted, int tracked) {
  StepRecord s;
  s.time = time;
  s.coverage = coverage;
  s.localization_error = error;
  s.predicted_features = predicted;
  s.tracked_features = tracked;
  s.path_length = 2.0 * time;
  s.plan_kind = PlanKind::kOptimised;
  return s;
}

TEST(MissionNumbers, MeasuresTheSteps) {
  std::vector<StepRecord> steps = {
      step(0.0, 0.1, 0.0, 60.0, 80), step(1.0, 0.5, 0.2, 20.0, 50),  // predicted 60: e = 10 / 50
      step(3.0, 0.85, 0.3, 999.0, 5),  // predicted 20: e = 15 / 20, not / 5
      step(4.0, 0.9, 0.1, 70.0, 100),  // after a stopping tail: no prediction
  };
  steps[2].plan_kind = PlanKind::kStoppingTail;
  steps[0].weights = {{"visible_features", 8.0, 1.5}, {"exploration_gain", -1.0, -1.0}};
  steps[1].weights = {{"visible_features", 8.0, 8.0}, {"exploration_gain", -1.0, 0.0}};
  Summary summary = summarize(steps);
  summary.duration_s = 5.0;
  summary.coverage = 0.95;
  summary.losses = 3;
  summary.path_length_m = 10.0;
  const MissionNumbers row = mission_numbers(summary, steps, 20.0);
  EXPECT_EQ(row.duration_s, 5.0);
  EXPECT_EQ(row.losses, 3.0);
  EXPECT_EQ(row.error_max_m, 0.3);
  EXPECT_NEAR(row.error_rms_m, std::sqrt(0.14 / 4.0), 1e-12);
  EXPECT_EQ(row.drift_m_per_m, 0.01);
  EXPECT_EQ(row.error_at_80_m, 0.3);
  EXPECT_EQ(row.coverage_at_10_cm, 0.5);
  EXPECT_EQ(row.coverage_at_25_cm, 0.85);
  EXPECT_EQ(row.coverage_at_50_cm, 0.95);  // never: that at the end
  EXPECT_EQ(row.few_share, 0.2);           // from 3 to 4 s of 5 s
  EXPECT_EQ(row.time_to_90_s, 4.0);
  EXPECT_EQ(row.weight_asked_visible_features, 8.0);
  EXPECT_EQ(row.weight_visible_features, 4.75);
  EXPECT_EQ(row.weight_asked_exploration_gain, -1.0);
  EXPECT_EQ(row.weight_exploration_gain, -0.5);
  EXPECT_NEAR(row.prediction_error, (0.2 + 0.75) / 2.0, 1e-12);
  EXPECT_NEAR(row.prediction_bias, (0.2 + 0.75) / 2.0, 1e-12);
}

TEST(MissionNumbers, RelativeErrorAndCoverageOverTimeAndPath) {
  // Straight ahead at 1 m/s; the estimate is 2 % too long.
  std::vector<StepRecord> steps;
  for (int n = 0; n <= 100; ++n) {
    StepRecord s = step(n, 0.01 * n, 0.0, 0.0, 50);
    s.path_length = n;
    s.true_pose.position.x() = n;
    s.estimated_pose.position.x() = 1.02 * n;
    s.estimated_pose.yaw = 0.3;  // as at the start: no error of the motion
    s.true_pose.yaw = 0.3;
    steps.push_back(s);
  }
  MissionNumbers row = mission_numbers(summarize(steps), steps, 20.0);
  EXPECT_NEAR(row.rpe_10_m_per_m, 0.02, 1e-9);
  EXPECT_DOUBLE_EQ(row.coverage_at_60_s, 0.61);
  EXPECT_DOUBLE_EQ(row.coverage_at_120_s, 1.0);  // it was shorter
  EXPECT_DOUBLE_EQ(row.coverage_at_20_m, 0.21);
  EXPECT_DOUBLE_EQ(row.coverage_at_40_m, 0.41);
  EXPECT_TRUE(std::isnan(row.prediction_error)) << "a planner that predicts nothing";
  steps.resize(8);
  row = mission_numbers(summarize(steps), steps, 20.0);
  EXPECT_TRUE(std::isnan(row.rpe_10_m_per_m)) << "shorter than 10 m";
}

TEST(MissionNumbers, TooManyTrackedIsANegativeBias) {
  const std::vector<StepRecord> steps = {
      step(0.0, 0.1, 0.0, 30.0, 80), step(1.0, 0.5, 0.0, 90.0, 40), step(2.0, 0.5, 0.0, 0.0, 60)};
  const MissionNumbers row = mission_numbers(summarize(steps), steps, 20.0);
  EXPECT_NEAR(row.prediction_error, (0.25 + 0.5) / 2.0, 1e-12);
  EXPECT_NEAR(row.prediction_bias, (-0.25 + 0.5) / 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(row.error_at_80_m));
}

TEST(MissionNumbers, ARunFolderThatIsNotWholeIsRefused) {
  EXPECT_THROW(mission_numbers_of_run(::testing::TempDir() + "no_such_run", 20.0), InputError);
}

TEST(MissionNumbers, EveryNumberIsListedOnce) {
  MissionNumbers all;
  std::set<std::string> names;
  for (const MissionNumber& number : mission_number_list()) {
    EXPECT_TRUE(names.insert(number.number.name).second) << number.number.name;
    EXPECT_TRUE(std::isnan(all.*number.member)) << number.number.name << ": in the list twice";
    all.*number.member = 1.0;
  }
  EXPECT_EQ(names.size() * sizeof(double), sizeof(MissionNumbers)) << "a number has no column";
}

}  // namespace
}  // namespace prospect::mission_numbers_test
