// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/mission_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/rcl_interfaces.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/log/logged_run.h"
#include "adapters/missions/log/planner_calls.h"
#include "adapters/missions/run/configured_record.h"
#include "adapters/views/report/report.h"
#include "tests/adapters/synthetic_run.h"

namespace prospect::mission_log_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class MissionLogTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "mission_log_" + std::to_string(getpid()) + ".mcap";
    configuration_ = configuration_from_text("mission: {time_limit: 77}\n", "test");
    start_.world = "eight rooms";
    start_.solver = "nlopt";
    start_.seed = 12345678901234567890ULL;
    start_.command_line = "prospect drive";
    start_.version = "1.2.3";
    start_.configuration = effective_yaml(configuration_.entries);
    options_.messages.robot = configuration_.robot;
    options_.file.wait = true;
  }
  void TearDown() override { fs::remove(path_); }

  /// A run whose robot is that of the configuration; stamps are times.
  RunRecord run(int steps) const {
    RunRecord record = synthetic_run(steps);
    const RunRecord robot = configured_record(configuration_);
    record.robot_radius = robot.robot_radius;
    record.sensor_range = robot.sensor_range;
    record.sensor_fov = robot.sensor_fov;
    record.configuration = robot.configuration;
    for (StepRecord& step : record.steps) step.stamp = step.time;
    return record;
  }

  static StereoFrame pair_at(double stamp) {
    return {stamp, stamp, std::make_shared<const Image>(8, 6, 7),
            std::make_shared<const Image>(8, 6, 9)};
  }

  std::string path_;
  Configuration configuration_;
  RunStart start_;
  MissionLogOptions options_;
};

TEST_F(MissionLogTest, TheReportIsThatOfTheRun) {
  RunRecord record = run(31);
  options_.images = true;
  {
    MissionLog log(path_, start_, options_);
    for (const StepRecord& step : record.steps) log.on_record(step, {});
    log.finish(record);
    EXPECT_THAT(log.notes(), testing::IsEmpty());
  }
  const LoggedRun read = read_logged_run(path_);
  EXPECT_THAT(read.notes, testing::IsEmpty());
  ASSERT_EQ(read.record.steps.size(), 31U);
  EXPECT_EQ(read.record.pictures.size(), record.pictures.size());
  // Pictures of the cost-to-go reach as far as it is known; angles of plans are rounded, within
  // what a page keeps.
  RunRecord again = read.record;
  for (std::size_t k = 0; k < 31; ++k) {
    EXPECT_EQ(again.steps[k].cost_to_go.has_value(), record.steps[k].cost_to_go.has_value());
    again.steps[k].cost_to_go = record.steps[k].cost_to_go;
    ASSERT_EQ(again.steps[k].horizon.size(), record.steps[k].horizon.size());
    for (std::size_t i = 0; i < again.steps[k].horizon.size(); ++i) {
      double& yaw = again.steps[k].horizon[i].yaw;
      const double told = record.steps[k].horizon[i].yaw;
      EXPECT_NEAR(std::remainder(yaw - told, 2.0 * M_PI), 0.0, 1e-12);
      yaw = told;
    }
  }
  EXPECT_TRUE(render_report(again) == render_report(record));
}

TEST_F(MissionLogTest, AKilledOneHasTheStepsThatCame) {
  RunRecord record = run(40);
  options_.file.longest_chunk = 0.0;
  options_.file.file.chunk_size = 20000;
  {
    MissionLog log(path_, start_, options_);
    for (const StepRecord& step : record.steps) log.on_record(step, {});
    log.finish(record);
  }
  fs::resize_file(path_, fs::file_size(path_) / 2);
  const LoggedRun read = read_logged_run(path_);
  const std::size_t steps = read.record.steps.size();
  EXPECT_GT(steps, 5U);
  EXPECT_LT(steps, 40U);
  EXPECT_THAT(read.notes,
              ElementsAre(HasSubstr("ends early"), HasSubstr("no summary; made of the " +
                                                             std::to_string(steps) + " steps")));
  EXPECT_EQ(read.record.summary.world, "eight rooms");
  EXPECT_EQ(read.record.summary.seed, 12345678901234567890ULL);
  EXPECT_EQ(read.record.summary.end, MissionEnd::kLogEndsEarly);
  EXPECT_EQ(read.record.summary.path_length_m, record.steps[steps - 1].path_length);
  EXPECT_EQ(read.record.steps.back().why, record.steps[steps - 1].why);
  EXPECT_THAT(render_report(read.record), HasSubstr("log ends early"));
}

// A plan is asked for ahead of its time, the next preparation now. Who reads a log reads it in the
// order of its stamps.
TEST_F(MissionLogTest, StampsOfPlannerCallsNeverGoBack) {
  options_.calls = true;
  {
    MissionLog log(path_, start_, options_);
    Belief belief;
    for (int n = 0; n < 10; ++n) {
      const double now = 5.0 + 0.1 * n;
      belief.stamp = now;
      log.on_prepare(belief);
      belief.stamp = now + 0.3;
      log.on_plan(belief);
      log.on_planned(Plan());
    }
    log.finish(RunRecord());
  }
  const BagFile bag = BagFile::open(path_);
  const BagTopic* calls = bag.find("/planner/calls");
  ASSERT_NE(calls, nullptr);
  EXPECT_EQ(calls->messages.size(), 30u);
  for (std::size_t n = 0; n < calls->messages.size(); ++n) {
    const std::string bytes = bag.read(calls->messages[n]);
    EXPECT_EQ(ros::from_cdr<PlannerCall>(bytes, "call").sequence, n);
  }
}

TEST_F(MissionLogTest, EveryTopicHasItsMessage) {
  options_.images = true;
  options_.messages.epoch = 1'000'000'000'000'000'000;  // in 2001
  options_.messages.depth_cameras[0].width = 4.0;
  options_.messages.depth_cameras[0].height = 3.0;
  options_.messages.depth_cameras[2] = {};
  options_.messages.depth_cameras[2].width = 2.0;
  options_.messages.robot.more_depth.resize(2);
  {
    MissionLog log(path_, start_, options_);
    Belief belief;
    belief.stamp = 1.5;
    belief.pose = {{1.0, 2.0, 0.25}, 0.5};
    belief.twist.yaw_rate = 0.125;
    belief.covariance(3, 0) = 0.75;
    log.on_belief(belief);
    log.on_command(1.6, {{0.25, 0.0, 0.0}, -0.5});
    Event event;
    event.last_stamp = 1.75;
    event.severity = Severity::kError;
    event.source = "guard";
    event.cause = "map";
    event.text = "something stands there";
    log.on_events({&event, 1});
    HealthReport health;
    health.stamp = 2.0;
    log.on_status(DriverStatus(), health);
    const DepthScan scan{{0.0, 0.0, 0.4}, {{1.0, 0.0, 0.4}}, {{0.0, 2.0, 0.4}}};
    log.on_frame(ScanFrame{2.0, std::make_shared<const DepthScan>(scan)});
    log.on_frame(WheelSample{2.0, {0.3, 0.0}, 0.1});
    ImuSample turning;
    turning.stamp = 2.0;
    turning.angular_velocity.y() = 0.25;
    turning.R_BS = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitX());
    log.on_frame(turning);
    log.on_frame(pair_at(2.0));
    log.on_frame(DepthFrame{2.0, std::make_shared<const DepthImage>(4, 3, 1.25F)});
    log.on_frame(DepthFrame{2.0, std::make_shared<const DepthImage>(2, 1, 1.0F), 1});
    log.on_frame(DepthFrame{2.5, std::make_shared<const DepthImage>(2, 1, 1.5F), 2});
    log.on_record(run(1).steps[0], {});
    log.finish(RunRecord());
  }
  const BagFile bag = BagFile::open(path_);
  const auto message = [&](const char* name) {
    const BagTopic* topic = bag.find(name);
    EXPECT_NE(topic, nullptr) << name;
    return topic && !topic->messages.empty() ? bag.read(topic->messages[0]) : std::string();
  };
  for (const char* name : {"/map", "/plan", "/plan/markers", "/plan/step", "/diagnostics",
                           "/truth/odometry", "/wheels", "/imu"}) {
    EXPECT_FALSE(message(name).empty()) << name;
  }
  const std::string odometry_bytes = message("/odometry");
  const auto odometry = ros::from_cdr<ros::Odometry>(odometry_bytes, "odometry");
  EXPECT_EQ(odometry.header.stamp.sec, 1'000'000'001);
  EXPECT_EQ(odometry.header.stamp.nanosec, 500'000'000U);
  EXPECT_EQ(odometry.header.frame_id, "map");
  EXPECT_EQ(odometry.pose.pose.position.y, 2.0);
  EXPECT_EQ(odometry.pose.covariance[6 * 5], 0.75) << "of yaw and x";
  EXPECT_EQ(odometry.twist.twist.angular.z, 0.125);
  EXPECT_EQ(bag.find("/odometry")->messages[0].time, 1'000'000'001'500'000'000);
  const std::string imu_bytes = message("/imu");
  const auto imu = ros::from_cdr<ros::Imu>(imu_bytes, "imu");
  EXPECT_EQ(imu.header.frame_id, "base_link");
  EXPECT_NEAR(imu.angular_velocity.z, 0.25, 1e-12) << "in the body's axes";
  EXPECT_EQ(imu.orientation_covariance[0], -1.0) << "it has none";
  const std::string log_bytes = message("/rosout");
  const auto said = ros::from_cdr<ros::Log>(log_bytes, "log");
  EXPECT_EQ(said.level, ros::Log::kError);
  EXPECT_EQ(said.name, "guard");
  EXPECT_EQ(said.msg, "map: something stands there");
  // By the readers of recordings.
  Elements transforms("transforms");
  EXPECT_EQ(read_ros_transforms(message("/tf"), "tf", transforms)[0].parent, "odom");
  EXPECT_EQ(read_ros_transforms(message("/tf_static"), "tf", transforms).size(), 9U);
  EXPECT_EQ(transforms.bad(), 0);
  const RawImage left = read_ros_image(message("/camera/left/image_rect"), false, "left");
  EXPECT_EQ(left.width, 8);
  EXPECT_EQ(read_ros_header(message("/camera/right/camera_info"), "info").frame,
            "camera_right_optical");
  EXPECT_EQ(read_ros_image(message("/camera/depth/image_rect"), false, "depth").width, 4);
  EXPECT_EQ(read_ros_image(message("/camera/depth_2/image_rect"), false, "depth").width, 2);
  EXPECT_EQ(read_ros_header(message("/camera/depth_2/camera_info"), "info").frame,
            "camera_depth_2_optical");
  EXPECT_EQ(bag.find("/camera/depth_1/image_rect"), nullptr) << "whose camera nobody knows";
  ASSERT_NE(bag.metadata("run"), nullptr);
  EXPECT_EQ(bag.metadata("run")->at("command_line"), "prospect drive");
  EXPECT_EQ(bag.metadata("run")->at("seed"), "12345678901234567890");
  EXPECT_THAT(bag.metadata("run")->at("configuration"), HasSubstr("time_limit: 77"));
}

TEST_F(MissionLogTest, DepthCamerasAreReadAsThoseOfOneRig) {
  options_.images = true;
  RobotDescription& robot = options_.messages.robot;
  robot.more_depth = {{robot.depth, {CameraMount::forward_facing({-0.1, 0.2, 0.3}, 2.0, 0.1)}}};
  for (const int sensor : {0, 1}) {
    PinholeCamera& camera = options_.messages.depth_cameras[sensor];
    camera.width = 4.0 + sensor, camera.height = 3.0;
    camera.fx = camera.fy = 4.0;
    camera.cx = 1.5, camera.cy = 1.0;
  }
  {
    MissionLog log(path_, start_, options_);
    for (int n = 0; n < 8; ++n) {
      Belief belief;
      belief.stamp = 1.0 + 0.5 * n;
      belief.pose = {{0.3 * n, 0.1, 0.0}, 0.2 * n};
      log.on_belief(belief);
    }
    for (const double stamp : {1.25, 2.5, 3.0}) {
      log.on_frame(DepthFrame{stamp, std::make_shared<const DepthImage>(4, 3, 1.25F)});
      log.on_frame(DepthFrame{stamp, std::make_shared<const DepthImage>(5, 3, 1.5F), 1});
    }
    log.finish(RunRecord());
  }
  const DepthSource source = open_depth_source(path_);
  ASSERT_THAT(source.missing, testing::IsEmpty());
  EXPECT_EQ(source.images.size(), 3U);
  ASSERT_EQ(source.more.size(), 1U);
  EXPECT_EQ(source.more[0].images.size(), 3U);
  EXPECT_EQ(source.more[0].camera.width, 5.0);
  const Eigen::Isometry3d T_FC = robot.depth_mount.T_BC.inverse() * robot.more_depth[0].mount.T_BC;
  EXPECT_TRUE(source.more[0].T_FC.isApprox(T_FC, 1e-6));
  EXPECT_TRUE(source.more[0].poses[1].isApprox(source.poses[1], 1e-9));
}

TEST_F(MissionLogTest, WithoutImagesThereAreNone) {
  {
    MissionLog log(path_, start_, options_);
    log.on_frame(pair_at(0.0));
    log.on_frame(DepthFrame{0.0, std::make_shared<const DepthImage>(4, 3)});
    log.on_record(run(1).steps[0], {});
    log.finish(run(1));
  }
  const BagFile bag = BagFile::open(path_);
  for (const BagTopic& topic : bag.topics())
    EXPECT_THAT(topic.name, testing::Not(HasSubstr("camera")));
}

TEST_F(MissionLogTest, WhatIsNoLogIsRefusedInOneLine) {
  const auto refusal = [&] {
    try {
      read_logged_run(path_);
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1U);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal(), HasSubstr("no such file; expected the log of a mission"));
  {
    McapWriter other(path_);
    const std::uint16_t channel = other.add_channel("/a", "std_msgs/msg/String", "string data\n");
    other.add_channel("/plan/step", "diagnostic_msgs/msg/DiagnosticArray", "");  // and no step
    other.message(channel, 0, "xxxx");
    other.close();
  }
  EXPECT_THAT(refusal(), HasSubstr("no /plan/step; expected the log of a mission"));
}

TEST_F(MissionLogTest, AMissionThatWasNotFitToDriveSaysWhy) {
  RunRecord record = run(1);
  record.steps.clear();
  record.summary.end = MissionEnd::kNotFit;
  record.summary.detail = "before the first motion: camera height: 0.1 m off";
  {
    MissionLog log(path_, start_, options_);
    log.finish(record);
  }
  const LoggedRun read = read_logged_run(path_);
  EXPECT_TRUE(read.record.steps.empty());
  EXPECT_EQ(read.record.summary.end, record.summary.end);
  EXPECT_EQ(read.record.summary.detail, record.summary.detail);
}

TEST_F(MissionLogTest, AConfigurationThatCannotBeReadCostsTheRobotOnly) {
  start_.configuration = "planner: {terms: {of_a_plugin: {}}}\n";
  {
    MissionLog log(path_, start_, options_);
    log.on_record(run(1).steps[0], {});
    log.finish(run(1));
  }
  const LoggedRun read = read_logged_run(path_);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("robot and zones are those of the defaults")));
  EXPECT_EQ(read.record.configuration, start_.configuration);
  EXPECT_EQ(read.record.steps.size(), 1U);
}

TEST(LevelScan, TakesTheRaysThatAreLevel) {
  DepthScan scan;
  scan.origin = {0.1, 0.0, 0.5};
  for (int i = -2; i <= 2; ++i) {
    const double a = 0.1 * i;
    const Eigen::Vector3d level(std::cos(a), std::sin(a), 0.0);
    if (i == 1) continue;  // no measurement
    if (i == 2) {
      scan.misses.push_back(scan.origin + level);
    } else {
      scan.hits.push_back(scan.origin + (3.0 + i) * level + Eigen::Vector3d(0, 0, 0.001));
    }
    scan.hits.push_back(scan.origin + 0.5 * (level + Eigen::Vector3d(0, 0, -0.5)));  // looks down
  }
  const ros::LaserScan beams = level_scan(scan, 4.0);
  ASSERT_EQ(beams.ranges.size(), 5U);
  EXPECT_NEAR(beams.angle_min, -0.2, 1e-6);
  EXPECT_NEAR(beams.angle_max, 0.2, 1e-6);
  EXPECT_NEAR(beams.angle_increment, 0.1, 1e-6);
  EXPECT_NEAR(beams.ranges[1], 2.0, 1e-6);
  EXPECT_NEAR(beams.ranges[2], 3.0, 1e-6);
  EXPECT_TRUE(std::isnan(beams.ranges[3]));
  EXPECT_EQ(beams.ranges[4], std::numeric_limits<float>::infinity());
  EXPECT_TRUE(level_scan({}, 4.0).ranges.empty());
}

}  // namespace
}  // namespace prospect::mission_log_test
