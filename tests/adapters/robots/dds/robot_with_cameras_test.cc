// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/robot_with_cameras.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "adapters/missions/config/configuration.h"
#include "adapters/robots/gazebo/gazebo_robot_model.h"

namespace prospect::robot_with_cameras_test {
namespace {

/// A configuration whose robot is told otherwise, and what its config.yaml reads back as.
struct Told {
  template <typename Tell>
  explicit Told(const Tell& tell)
      : now(configuration_from_text("{robot: {stereo: {cx: 300, sigma_u: 0.7}}}", "f.yaml")) {
    set_cameras(now, tell(now.robot), "the cameras");
    again = configuration_from_text(effective_yaml(now.entries), "config.yaml");
  }
  Configuration now, again;
};

/// The bits of what a planner is told of the cameras.
void expect_same(const RobotDescription& a, const RobotDescription& b) {
  for (const auto member : {&PinholeCamera::fx, &PinholeCamera::fy, &PinholeCamera::cx,
                            &PinholeCamera::cy, &PinholeCamera::width, &PinholeCamera::height}) {
    EXPECT_EQ(a.stereo.left.*member, b.stereo.left.*member);
  }
  EXPECT_EQ(a.stereo.baseline, b.stereo.baseline);
  EXPECT_EQ(a.stereo.sigma_u, b.stereo.sigma_u);
  EXPECT_EQ(a.stereo_mount.T_BC.matrix(), b.stereo_mount.T_BC.matrix());
  EXPECT_EQ(a.depth_mount.T_BC.matrix(), b.depth_mount.T_BC.matrix());
  EXPECT_EQ(a.depth.horizontal_fov, b.depth.horizontal_fov);
  EXPECT_EQ(a.depth.vertical_fov, b.depth.vertical_fov);
}

DdsCameras cameras() {
  DdsCameras out;
  out.stereo.emplace();
  out.stereo->left = {431.7021484375, 430.1, 323.123456789, 233.3, 656.0, 488.0};
  out.stereo->baseline = 0.0998877665544;
  return out;
}

TEST(RobotWithCameras, WhatTopicsDoNotTellStays) {
  const Told told([](const RobotDescription& robot) { return robot_with(cameras(), robot); });
  const RobotDescription& robot = told.now.robot;
  const RobotDescription file = configuration_from_text("", "f.yaml").robot;
  EXPECT_EQ(robot.stereo.left.fx, 431.7021484375);
  EXPECT_EQ(robot.stereo.left.fy, 430.1);
  EXPECT_EQ(robot.stereo.left.cx, 323.123456789);
  EXPECT_EQ(robot.stereo.left.cy, 233.3);
  EXPECT_EQ(robot.stereo.left.width, 656.0);
  EXPECT_EQ(robot.stereo.left.height, 488.0);
  EXPECT_EQ(robot.stereo.baseline, 0.0998877665544);
  EXPECT_EQ(robot.stereo.sigma_u, 0.7);
  EXPECT_EQ(robot.depth.horizontal_fov, file.depth.horizontal_fov);
  EXPECT_EQ(robot.stereo_mount.T_BC.matrix(), file.stereo_mount.T_BC.matrix());
  EXPECT_EQ(robot.depth_mount.T_BC.matrix(), file.depth_mount.T_BC.matrix());
  expect_same(robot, told.again.robot);
}

// Mounts of tf have any attitude: level, tilted, upside down, straight down, backwards.
TEST(RobotWithCameras, MountsAndTheDepthCameraReadBackAsTheyAre) {
  for (const double pitch : {0.0, 0.35, -1.2, M_PI / 2.0, -M_PI / 2.0}) {
    for (const double yaw : {0.0, 1.1, -2.3, M_PI, -M_PI}) {
      for (const double roll : {0.0, 0.02, -1.7, M_PI, -M_PI}) {
        DdsCameras seen = cameras();
        seen.depth = PinholeCamera{381.0, 382.0, 319.25, 241.0, 640.0, 480.0};
        seen.stereo_mount = {CameraMount::forward_facing({0.1, -0.06, 0.31}, yaw, pitch, roll)};
        seen.depth_mount = {CameraMount::forward_facing({0.1, 0.0, 1.0 / 3.0}, roll, pitch, yaw)};
        const Told told([&](const RobotDescription& robot) { return robot_with(seen, robot); });
        const RobotDescription& robot = told.now.robot;
        EXPECT_LE((robot.stereo_mount.T_BC.matrix() - seen.stereo_mount->T_BC.matrix()).norm(),
                  1e-14);
        EXPECT_LE((robot.depth_mount.T_BC.matrix() - seen.depth_mount->T_BC.matrix()).norm(),
                  1e-14);
        EXPECT_NEAR(robot.depth.horizontal_fov, seen.depth->horizontal_fov(), 1e-14);
        EXPECT_NEAR(robot.depth.vertical_fov, seen.depth->vertical_fov(), 1e-14);
        expect_same(robot, told.again.robot);
      }
    }
  }
}

TEST(RobotWithCameras, ALidarTellsItsViewAndNothingOfTheCameras) {
  const RobotDescription file = configuration_from_text("", "f.yaml").robot;
  DdsCameras seen;
  seen.lidar = {2.0 * M_PI, 0.1, 30.0, {CameraMount::forward_facing({0.1, 0.0, 0.3}, 0.5)}};
  const Told told([&](const RobotDescription& robot) { return robot_with(seen, robot); });
  const RobotDescription& robot = told.now.robot;
  EXPECT_EQ(robot.depth.horizontal_fov, 2.0 * M_PI);
  EXPECT_EQ(robot.depth.vertical_fov, 0.0);
  EXPECT_EQ(robot.depth.min_range, 0.1);
  EXPECT_EQ(robot.depth.max_range, file.depth.max_range) << "no farther than is asked for";
  EXPECT_LE((robot.depth_mount.T_BC.matrix() - seen.lidar->mount.T_BC.matrix()).norm(), 1e-14);
  EXPECT_EQ(robot.stereo.left.fx, file.stereo.left.fx);
  expect_same(robot, told.again.robot);
  seen.lidar->max_range = 2.5;
  EXPECT_EQ(robot_with(seen, file).depth.max_range, 2.5);
}

TEST(RobotWithCameras, GazeboHasThePrincipalPointInTheMiddle) {
  const Told told([](RobotDescription robot) {
    robot.stereo.left.width = 641.0;
    robot.stereo.left.height = 480.0;
    return gazebo_robot(robot);
  });
  EXPECT_EQ(told.now.robot.stereo.left.cx, 320.0);
  EXPECT_EQ(told.now.robot.stereo.left.cy, 239.5);
  EXPECT_EQ(told.now.robot.stereo.sigma_u, 0.7);
  expect_same(told.now.robot, told.again.robot);
}

}  // namespace
}  // namespace prospect::robot_with_cameras_test
