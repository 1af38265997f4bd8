// SPDX-License-Identifier: Apache-2.0
// Missions whose map is corrected on the way.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/octree_file.h"
#include "adapters/formats/worlds/world_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/step_row.h"
#include "engine/maps/correction.h"
#include "engine/task/zone_map.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::corrected_mission_test {
namespace {

constexpr const char* kRoom =
    "resolution: 0.1\n"
    "textures: {brick: 40}\n"
    "rooms:\n"
    "  - {box: [0, 0, 6, 4], walls: brick, floor: brick}\n"
    "start: [1.0, 1.0, 0.5]\n";

/// By what it is told alone.
RunRecord run(const std::string& settings) {
  const Configuration c =
      configuration_from_text(settings + "perception: {loops: false}\n", "corrected");
  World world = world_from_yaml(kRoom, "a room");
  place_start(world, world_options_for(c).slice, std::nullopt, true);
  return run_exploration(std::make_shared<const World>(std::move(world)), c, {}).record;
}

std::vector<std::string> rows_of(const RunRecord& record) {
  const StepColumns columns = step_columns(record.steps);
  std::vector<std::string> rows = {step_header(columns)};
  for (const StepRecord& step : record.steps) rows.push_back(step_row(step, columns));
  return rows;
}

TEST(CorrectedMission, GoalAndKeepOutStayWhereTheyAreInTheMap) {
  // From the second on the map is off by a metre and 20 degrees, about where the robot is then.
  const std::string told =
      "task: {kind: go, goal: [4.6, 2.6]}\n"
      "zones: {keep_out: [{area: [2.6, 1.0, 3.0, 1.0, 3.0, 2.0, 2.6, 2.0]}]}\n"
      "mission: {time_limit: 60}\n"
      "simulator: {corrections: [2, 0.7, -0.6, 10, 2.01, 1, 1, 1, 3, 5000, 0, 0]}\n";
  const RunRecord record = run(told);
  EXPECT_EQ(record.summary.end, MissionEnd::kGoalReached) << record.summary.detail;
  EXPECT_EQ(record.summary.collisions, 0);
  const StepRecord& last = record.steps.back();
  ASSERT_TRUE(last.map_frame);
  EXPECT_EQ(last.map_frame->taken, 1);
  EXPECT_EQ(last.map_frame->refused, 2) << "too soon; too far";
  MapFrame frame;
  frame.origin = last.map_frame->origin;
  const Eigen::Vector2d there = frame.to_map(last.estimated_pose.position.head<2>());
  EXPECT_LT((there - Eigen::Vector2d(4.6, 2.6)).norm(), 0.16);
  const Configuration c = configuration_from_text(told, "corrected");
  const ZoneMap zones(c.planner.zones);
  int corrections = 0;
  for (const StepRecord& step : record.steps) {
    frame.origin = step.map_frame->origin;
    EXPECT_GE(zones.gap(0, body_outline(c.robot.shape), frame.to_map(step.estimated_pose)), 0.0);
    corrections += step.map_frame->distance.has_value();
  }
  EXPECT_EQ(corrections, 1);
  const std::vector<std::string> rows = rows_of(record);
  EXPECT_NE(rows.front().find(",map_x,map_y,map_yaw,corrections,"), std::string::npos);
  EXPECT_EQ(rows, rows_of(run(told))) << "the same bytes again";
}

TEST(CorrectedMission, AnExplorationThatWasToldNothingGoesTheSameWay) {
  const std::string plain = "mission: {time_limit: 15}\n";
  const RunRecord without = run(plain);
  const RunRecord with = run(plain + "simulator: {corrections: [4, 3, 0, 30]}\n");
  EXPECT_FALSE(without.steps.back().map_frame);
  EXPECT_EQ(rows_of(without).front().find("map_x"), std::string::npos);
  ASSERT_EQ(without.steps.size(), with.steps.size());
  for (std::size_t k = 0; k < with.steps.size(); ++k) {
    EXPECT_EQ(without.steps[k].explanation.cost, with.steps[k].explanation.cost);
    EXPECT_EQ(without.steps[k].true_pose.position, with.steps[k].true_pose.position);
  }
}

// The robot is told that it is elsewhere in what it has drawn: all that it drew moves.
TEST(CorrectedMission, ARobotThatIsMovedInItsMapGoesOn) {
  const std::string told =
      "mission: {time_limit: 40}\n"
      "simulator: {robot_corrections: [4, 0.5, 0.3, 20, 4.01, 1, 1, 1, 12, -1.2, 0.4, -30]}\n";
  const RunRecord record = run(told);
  EXPECT_EQ(record.summary.collisions, 0);
  const StepRecord& last = record.steps.back();
  ASSERT_TRUE(last.map_frame);
  EXPECT_EQ(last.map_frame->taken, 2);
  EXPECT_EQ(last.map_frame->refused, 1);
  double farthest = 0.0;
  for (const StepRecord& step : record.steps) {
    farthest = std::max(farthest, step.map_frame->distance.value_or(0.0));
  }
  EXPECT_GT(farthest, 0.5);
  EXPECT_EQ(rows_of(record), rows_of(run(told))) << "the same bytes again";
}

// An odometry that errs by far more than it does. Where it has drawn the robot, and where that is
// in the map: of one drive, as another one errs otherwise.
TEST(CorrectedMission, PlacesThatAreSeenAgainKeepTheMapStraight) {
  NOT_UNDER_SANITIZERS("a mission, of parts that are tested by themselves");
  ExplorationRunOptions options;
  options.seed = 1;
  const RunRecord record =
      run_exploration(std::make_shared<const World>(load_world("office")),
                      configuration_from_text(
                          "mission: {time_limit: 60}\n"
                          "simulator: {odometry: {position_sigma: 0.004, heading_sigma: 0.004}}\n",
                          "drifts"),
                      options)
          .record;
  EXPECT_EQ(record.summary.collisions, 0);
  ASSERT_TRUE(record.steps.back().map_frame);
  EXPECT_GT(record.steps.back().map_frame->taken, 0);
  double drawn = 0.0, corrected = 0.0;
  for (const StepRecord& s : record.steps) {
    drawn += (s.estimated_pose.position - s.true_pose.position).head<2>().squaredNorm();
    corrected += s.localization_error * s.localization_error;
  }
  const double n = static_cast<double>(record.steps.size());
  std::printf("rms error %.3f m as drawn, %.3f corrected\n", std::sqrt(drawn / n),
              std::sqrt(corrected / n));
  EXPECT_LT(corrected, 0.5 * drawn);
}

bool found_its_place(const RunRecord& record) {
  return std::any_of(record.steps.begin(), record.steps.end(), [](const StepRecord& s) {
    return s.map_frame && s.map_frame->why.find("place in the map was found") != std::string::npos;
  });
}

TEST(CorrectedMission, ARobotThatIsCarriedFindsItsPlaceByTheMap) {
  NOT_UNDER_SANITIZERS("a mission, of parts that are tested by themselves");
  ExplorationRunOptions options;
  options.seed = 1;
  const auto world = std::make_shared<const World>(load_world("office"));
  const RunRecord record =
      run_exploration(world,
                      configuration_from_text("mission: {time_limit: 130}\n"
                                              "simulator: {carried: [60, 1.3, 5.2, 100]}\n",
                                              "carried"),
                      options)
          .record;
  double farthest = 0.0;
  for (const StepRecord& s : record.steps) farthest = std::max(farthest, s.localization_error);
  const StepRecord& last = record.steps.back();
  std::printf("%.2f m off, %.3f m at the end\n", farthest, last.localization_error);
  EXPECT_GT(farthest, 2.0);
  EXPECT_TRUE(found_its_place(record));
  EXPECT_LT(last.localization_error, 0.15);
  EXPECT_EQ(record.summary.collisions, 0);
}

TEST(CorrectedMission, BeginsAnywhereInAMapThatWasMadeBefore) {
  NOT_UNDER_SANITIZERS("a mission, of parts that are tested by themselves");
  ExplorationRunOptions options;
  options.seed = 1;
  const auto world = std::make_shared<const World>(load_world("office"));
  const ExplorationRunResult first = run_exploration(
      world, configuration_from_text("mission: {time_limit: 60}\n", "first"), options);
  const std::string map =
      (std::filesystem::temp_directory_path() / ("begins anywhere " + std::to_string(::getpid())))
          .string() +
      ".bt";
  write_octree(*first.map, map);
  World elsewhere = *world;
  const StepRecord& there = first.record.steps[first.record.steps.size() / 2];
  elsewhere.start.position.head<2>() = there.true_pose.position.head<2>();
  elsewhere.start.yaw = there.true_pose.yaw + 2.0;
  const RunRecord record =
      run_exploration(std::make_shared<const World>(elsewhere),
                      configuration_from_text("mission: {time_limit: 40}\n"
                                              "simulator: {place_known: false, map: '" +
                                                  map + "'}\n",
                                              "second"),
                      options)
          .record;
  std::filesystem::remove(map);
  EXPECT_TRUE(found_its_place(record));
  EXPECT_LT(record.steps.back().localization_error, 0.15);
  EXPECT_EQ(record.summary.collisions, 0);
}

}  // namespace
}  // namespace prospect::corrected_mission_test
