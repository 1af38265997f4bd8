// SPDX-License-Identifier: Apache-2.0
// A robot behind topics of ROS 2 that has a lidar, wheels, and somebody who says where it is.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/dds_run.h"
#include "tests/adapters/box_room.h"
#include "tests/adapters/dds_lidar_robot.h"
#include "tests/adapters/dds_pair.h"
#include "tests/adapters/record_observer.h"

namespace prospect::lidar_mission_test {
namespace {

DdsOptions topics_of(DdsOptions::PoseSource source) {
  DdsOptions o;
  o.address = test::dds_test_address("prospect");
  o.timeout = test::kPatience;
  o.pose_source = source;
  if (source == DdsOptions::PoseSource::kTopic) o.pose.topic = "/pose";
  o.pose.frame = o.frames.base;
  o.stereo.left = o.stereo.left_info = o.stereo.right = o.stereo.right_info = "";
  o.depth.image = o.depth.info = "";
  o.scan = "/scan";
  o.command.dead_man = 0.5;
  o.output.transforms = false;
  o.output.map = "/prospect/map";
  return o;
}

std::vector<std::string> causes_of(const std::vector<Event>& events) {
  std::vector<std::string> causes;
  for (const Event& event : events) causes.push_back(event.cause);
  return causes;
}

/// Two rooms, of which the robot sees one.
World rooms() {
  World world = test::box_room(7.0, 4.0);
  test::fill(world, {3.4, 0.0, 0.0}, {3.6, 1.4, 2.0});
  test::fill(world, {3.4, 2.6, 0.0}, {3.6, 4.0, 2.0});
  world.start.position = {1.2, 1.0, 0.0};
  world.start.yaw = 1.0;
  return world;
}

const std::string kRobot =
    "robot:\n"
    "  shape: {type: cylinder, radius: 0.18, height: 0.4, center: [0, 0, 0.3]}\n"
    "  depth: {max_range: 3, mount: {position: [0.05, 0, 0.3]}}\n";

// It drives, though nothing that localizes it can be seen; a pose that jumps stops it, and it goes
// on from there; one that falls silent stops it for good.
TEST(LidarMission, ExploresByAPoseOfAnother) {
  const Configuration c = configuration_from_text(
      kRobot + "drive: {preflight: {turn: 0.15, distance: 0.03}}\nmission: {time_limit: 60}\n",
      "lidar");
  const World world = rooms();
  const DdsOptions topics = topics_of(DdsOptions::PoseSource::kTf);
  test::DdsLidarRobot robot(world, c.robot, topics, test::dds_test_address("robot"));

  const SteadyClock clock;
  double way = 0.0, jumped = 0.0, way_after = 0.0, silent = 0.0;
  Pose at;
  ExplorationRunOptions options;
  test::RecordObserver observer([&](const StepRecord& step) {
    const double moved = (step.estimated_pose.position - at.position).norm();
    if (at.position.norm() > 0.0 && moved < 0.5) (jumped > 0.0 ? way_after : way) += moved;
    at = step.estimated_pose;
    if (way > 0.8 && jumped == 0.0) robot.shift(0.5), jumped = clock.now();
    if (way_after > 0.3 && silent == 0.0) robot.silence(), silent = clock.now();
  });
  options.observers = std::ref(observer);
  options.cancelled = [&] { return silent > 0.0 && clock.now() > silent + 2.0; };
  const ExplorationRunResult result = explore_dds(c, topics, options);
  robot.stop();
  EXPECT_GT(way, 0.8) << result.record.summary.detail << to_text(result.preflight);
  EXPECT_THAT(causes_of(result.events), ::testing::Contains("correction"))
      << "odometry did not jump";
  EXPECT_GT(way_after, 0.3) << "it goes on";
  EXPECT_THAT(causes_of(result.events), ::testing::Contains("source stale"));
  EXPECT_EQ(robot.body().collisions(), 0);
  EXPECT_GT(robot.body().path_length(), 1.0);
  for (const CheckResult& check : result.preflight) {
    EXPECT_NE(check.verdict, CheckVerdict::kFailed) << check.check << ": " << check.why;
    EXPECT_THAT(check.check, ::testing::Not(::testing::HasSubstr("camera")));
  }
}

// Where it begins is where it is said to be, and that is free; how fast it is its poses tell alone.
TEST(LidarMission, DrivesByMotionCaptureAlone) {
  const Configuration c = configuration_from_text(
      kRobot + "drive: {preflight: {turn: 0.15, distance: 0.03}}\nmission: {time_limit: 60}\n",
      "lidar");
  const World world = rooms();
  DdsOptions topics = topics_of(DdsOptions::PoseSource::kTopic);
  topics.odometry.clear();
  test::DdsLidarRobot robot(world, c.robot, topics, test::dds_test_address("robot"));
  int steps = 0;
  double way = 0.0;
  Pose at;
  ExplorationRunOptions options;
  test::RecordObserver observer([&](const StepRecord& step) {
    if (steps > 0) way += (step.estimated_pose.position - at.position).norm();
    at = step.estimated_pose;
    if (steps++ > 0) return;
    EXPECT_LT((step.estimated_pose.position - robot.start().position).head<2>().norm(), 0.1);
    EXPECT_EQ(step.localization, Localization::kOk);
    EXPECT_EQ(step.features_weight, 0.0) << "features do not localize it";
  });
  options.observers = std::ref(observer);
  options.cancelled = [&] { return way > 1.0; };
  const ExplorationRunResult result = explore_dds(c, topics, options);
  robot.stop();
  EXPECT_GT(way, 1.0) << result.record.summary.detail << to_text(result.preflight);
  EXPECT_EQ(robot.body().collisions(), 0);
  for (const CheckResult& check : result.preflight) {
    EXPECT_NE(check.verdict, CheckVerdict::kFailed) << check.check << ": " << check.why;
  }
  for (const Event& event : result.events)
    EXPECT_LT(event.severity, Severity::kError) << event.text;
}

// Faults on purpose are those of each robot.
TEST(LidarMission, ABaseThatIsBrokenOnPurposeIsNoticedBeforeItDrives) {
  const Configuration c = configuration_from_text(
      kRobot + "drive: {preflight: {turn: 0.15, distance: 0.03}}\nmission: {time_limit: 60}\n",
      "lidar");
  const World world = rooms();
  const DdsOptions topics = topics_of(DdsOptions::PoseSource::kTf);
  test::DdsLidarRobot robot(world, c.robot, topics, test::dds_test_address("robot"));
  ExplorationRunOptions options;
  options.real_time = RealTimeRun{{parse_fault("base:mirrored")}};
  const ExplorationRunResult result = explore_dds(c, topics, options);
  robot.stop();
  EXPECT_EQ(result.record.summary.end, MissionEnd::kNotFit);
  EXPECT_THAT(result.record.summary.detail, ::testing::HasSubstr("yaw"));
  EXPECT_EQ(robot.body().collisions(), 0);
  EXPECT_LT(robot.body().path_length(), 0.1);
}

}  // namespace
}  // namespace prospect::lidar_mission_test
