// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/step_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"
#include "tests/adapters/synthetic_run.h"

namespace prospect::step_messages_test {
namespace {

/// Through the bytes, as a log does.
template <typename T>
T through(const T& message, std::string& bytes) {
  bytes = ros::to_cdr(message);
  return ros::from_cdr<T>(bytes, "message");
}

StepRecord step() {
  StepRecord s = synthetic_run(21).steps[20];
  s.goal = Eigen::Vector2d(4.5, -0.25);
  s.goal_yaw = 0.75;
  s.coverage = std::numeric_limits<double>::quiet_NaN();
  s.clearance = std::numeric_limits<double>::infinity();
  s.guard_stops = 2;
  s.guard_reason = GuardReason::kMap;
  s.wall.polish = 1.0 / 3.0;
  s.weights = {{"visible_features", 8.0, 1.0625}, {"exploration_gain", -1.0, 0.0}};
  s.explanation.terms.push_back({"clearance", "m", 0.125, 0.0, true});
  return s;
}

TEST(StepMessages, ValuesAreReadBackExactly) {
  const StepRecord s = step();
  std::string bytes;
  const ros::DiagnosticArray array = through(step_values(s, 1'500'000'000), bytes);
  EXPECT_EQ(array.header.stamp.sec, 1);
  EXPECT_EQ(array.header.stamp.nanosec, 500'000'000U);
  EXPECT_EQ(array.status[0].level, ros::DiagnosticStatus::kWarn) << "the guard has braked";
  EXPECT_EQ(array.status[0].message, s.why);
  StepRecord r;
  read_step_values(array, "message", r);
  EXPECT_EQ(r.step, s.step);
  EXPECT_EQ(r.time, s.time);
  EXPECT_EQ(r.estimated_pose.position, s.estimated_pose.position);
  EXPECT_EQ(r.estimated_pose.yaw, s.estimated_pose.yaw);
  EXPECT_EQ(r.true_pose.position, s.true_pose.position);
  EXPECT_EQ(r.command.yaw_rate, s.command.yaw_rate);
  EXPECT_TRUE(std::isnan(r.coverage));
  EXPECT_EQ(r.clearance, s.clearance);
  EXPECT_EQ(r.guard_stops, 2);
  EXPECT_EQ(r.guard_reason, GuardReason::kMap);
  EXPECT_EQ(r.goal, s.goal);
  EXPECT_EQ(r.goal_yaw, s.goal_yaw);
  ASSERT_TRUE(r.target.has_value());
  EXPECT_EQ(r.target->viewpoint, s.target->viewpoint);
  EXPECT_EQ(r.target->path_left, s.target->path_left);
  EXPECT_EQ(r.mode, s.mode);
  EXPECT_EQ(r.certified, s.certified);
  EXPECT_EQ(r.wall.polish, s.wall.polish);
  ASSERT_EQ(r.explanation.terms.size(), s.explanation.terms.size());
  EXPECT_EQ(r.explanation.cost, s.explanation.cost);
  for (std::size_t i = 0; i < r.explanation.terms.size(); ++i) {
    EXPECT_EQ(r.explanation.terms[i].name, s.explanation.terms[i].name);
    EXPECT_EQ(r.explanation.terms[i].raw, s.explanation.terms[i].raw);
    EXPECT_EQ(r.explanation.terms[i].weighted, s.explanation.terms[i].weighted);
    EXPECT_EQ(r.explanation.terms[i].constraint, s.explanation.terms[i].constraint);
  }
  ASSERT_EQ(r.weights.size(), 2U);
  for (std::size_t i = 0; i < r.weights.size(); ++i) {
    EXPECT_EQ(r.weights[i].name, s.weights[i].name);
    EXPECT_EQ(r.weights[i].asked, s.weights[i].asked);
    EXPECT_EQ(r.weights[i].in_effect, s.weights[i].in_effect);
  }
  ASSERT_EQ(r.candidates.size(), s.candidates.size());
  ASSERT_FALSE(s.candidates.empty());
  for (std::size_t i = 0; i < r.candidates.size(); ++i) {
    EXPECT_EQ(r.candidates[i].name, s.candidates[i].name);
    EXPECT_EQ(to_string(r.candidates[i].verdict), to_string(s.candidates[i].verdict));
    EXPECT_EQ(r.candidates[i].polished, s.candidates[i].polished);
    EXPECT_EQ(r.candidates[i].explanation.cost, s.candidates[i].explanation.cost);
  }
}

TEST(StepMessages, WhatAStepLacksHasNoEntry) {
  StepRecord s, r;
  std::string bytes;
  read_step_values(through(step_values(s, 0), bytes), "message", r);
  EXPECT_FALSE(r.goal || r.goal_yaw || r.target);
  EXPECT_TRUE(r.candidates.empty());
  read_step_values({}, "message", r);  // of another program: no status
}

TEST(StepMessages, AValueThatIsNoNumberIsRefusedByName) {
  ros::DiagnosticArray array = step_values(StepRecord(), 0);
  for (ros::KeyValue& entry : array.status[0].values) {
    if (entry.key == "coverage") entry.value = "much";
  }
  StepRecord r;
  try {
    read_step_values(array, "run.mcap: message 3", r);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "run.mcap: message 3: coverage is 'much'; expected a number");
  }
}

TEST(StepMessages, HorizonAndMarkersAreReadBack) {
  StepRecord s = step();
  s.horizon.push_back({{1.0, 2.0, 0.5}, 3.0});
  StepRecord r;
  std::string bytes;
  const ros::Path path = through(horizon_path(s, 0.25, 2'000'000'000), bytes);
  EXPECT_EQ(path.poses[1].header.stamp.nanosec, 250'000'000U);
  read_horizon_path(path, r);
  ASSERT_EQ(r.horizon.size(), s.horizon.size());
  for (std::size_t k = 0; k < r.horizon.size(); ++k) {
    EXPECT_EQ(r.horizon[k].position, s.horizon[k].position);
    EXPECT_NEAR(std::remainder(r.horizon[k].yaw - s.horizon[k].yaw, 2.0 * M_PI), 0.0, 1e-12);
  }
  read_step_values(step_values(s, 0), "message", r);
  read_step_markers(through(step_markers(s, 0.1, 0), bytes), r);
  EXPECT_EQ(r.frontier_cells, s.frontier_cells);
  ASSERT_FALSE(s.landmarks.empty());
  ASSERT_EQ(r.landmarks.size(), s.landmarks.size());
  for (std::size_t i = 0; i < r.landmarks.size(); ++i) {
    EXPECT_EQ(r.landmarks[i].x, s.landmarks[i].x);
    EXPECT_EQ(r.landmarks[i].visibility, s.landmarks[i].visibility);
  }
  for (std::size_t i = 0; i < r.candidates.size(); ++i) {
    EXPECT_EQ(r.candidates[i].path, s.candidates[i].path);
  }
}

TEST(StepMessages, FrontiersAreReadBackInTheirOrder) {
  using Why = FrontierStanding::Why;
  StepRecord step;
  step.standings = {{{1.5, -2.0}, Why::kInOrder, 3.25, 4.0, 8.5},
                    {{0.25, 7.0}, Why::kFarther, 1.0, 1.25, FrontierStanding::kNone},
                    {{4.0, 4.0}, Why::kLittle, 0.0625, 0.125, 12.0}};
  const ros::MarkerArray markers = frontier_markers(step, 0);
  ASSERT_EQ(markers.markers.size(), 4U);
  EXPECT_EQ(markers.markers[0].action, ros::Marker::kDeleteAll);
  EXPECT_EQ(markers.markers[1].text, "1: 3.25 m2 in 8.5 s");
  EXPECT_EQ(markers.markers[2].text, "farther: 1.00 m2");
  StepRecord back;
  back.standings.resize(7);  // replaced, not added to
  read_frontier_markers(markers, back);
  ASSERT_EQ(back.standings.size(), step.standings.size());
  for (std::size_t i = 0; i < back.standings.size(); ++i) {
    EXPECT_EQ(back.standings[i].place, step.standings[i].place);
    EXPECT_EQ(back.standings[i].why, step.standings[i].why);
    EXPECT_EQ(back.standings[i].area, step.standings[i].area);
    EXPECT_EQ(back.standings[i].unknown, step.standings[i].unknown);
    EXPECT_EQ(back.standings[i].time, step.standings[i].time);
  }
}

TEST(StepMessages, CostToGoKeepsItsKnownCells) {
  CostToGoPicture picture;
  picture.frame = {0.2, -3, 5, 4, 3};
  picture.seconds.assign(12, std::numeric_limits<float>::quiet_NaN());
  picture.seconds[1] = 1.5F;
  picture.seconds[6] = 2.25F;
  std::string points, bytes;
  const CostToGoPicture read =
      read_cost_to_go_points(through(cost_to_go_points(picture, 0, points), bytes), 0.2);
  EXPECT_EQ(read.frame, (GridFrame{0.2, -2, 5, 2, 2})) << "as far as it is known";
  EXPECT_EQ(read.seconds[0], 1.5F);
  EXPECT_TRUE(std::isnan(read.seconds[1]));
  EXPECT_EQ(read.seconds[3], 2.25F);
  EXPECT_TRUE(read_cost_to_go_points({}, 0.2).seconds.empty());
}

}  // namespace
}  // namespace prospect::step_messages_test
