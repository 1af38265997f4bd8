// SPDX-License-Identifier: Apache-2.0
// The simulated cameras and the odometry that is to run on them: images good enough to follow, and
// walls without texture that nobody can follow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/world_mesh.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/stereo_odometry.h"
#include "tests/adapters/box_room.h"

namespace prospect::camera_odometry_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kPeriod = 0.1;  // [s]

std::shared_ptr<const SceneRenderer> scene_of(const World& world, double quality) {
  const FeatureField field(
      world, [&](int i, int j, int k) { return texture_density(world, i, j, k, 1); }, 1);
  return std::make_shared<const SceneRenderer>(world_mesh(world, field, {quality}));
}

struct Drive {
  double length = 0.0;  // [m]
  double turned = 0.0;  // [rad]
  double worst = 0.0;   // [m] error of the position
  double angle = 0.0;   // [rad] error of the attitude at the end
  int ok = 0, frames = 0;
  Localization state = Localization::kLost;  // at the end
};

/// Drives with a body twist from `start` and follows by odometry.
Drive drive(const CameraRig& rig, Pose start, const std::vector<Twist>& twists) {
  Drive result;
  Pose pose = start;
  StereoOdometry odometry(rig.options().stereo, {}, camera_pose(pose, rig.options().stereo_mount));
  for (std::size_t k = 0; k <= twists.size(); ++k) {
    const Twist twist = twists[std::min(k, twists.size() - 1)];
    const ImagePair pair = rig.stereo(pose, twist, k);
    const OdometryFrame frame =
        odometry.process(kPeriod * static_cast<double>(k), pair.left.view(), pair.right.view());
    const Isometry3d truth = camera_pose(pose, rig.options().stereo_mount);
    result.worst = std::max(result.worst, (frame.T_WC.translation() - truth.translation()).norm());
    result.angle = Eigen::AngleAxisd(frame.T_WC.linear().transpose() * truth.linear()).angle();
    result.ok += frame.state == Localization::kOk;
    result.state = frame.state;
    ++result.frames;
    pose.yaw += 0.5 * twist.yaw_rate * kPeriod;
    pose.position += Eigen::AngleAxisd(pose.yaw, Vector3d::UnitZ()) * twist.linear * kPeriod;
    pose.yaw += 0.5 * twist.yaw_rate * kPeriod;
    result.length += twist.linear.norm() * kPeriod;
    result.turned += std::abs(twist.yaw_rate) * kPeriod;
  }
  return result;
}

CameraRigOptions real() {
  CameraRigOptions options;
  options.exposure_time = 0.005;
  return options;
}

void print(const char* what, const Drive& d) {
  std::printf(
      "%s: %.2f m and %.2f rad, %d of %d frames ok, worst error %.1f mm (%.2f %%), attitude "
      "%.3f deg\n",
      what, d.length, d.turned, d.ok, d.frames, 1e3 * d.worst, 100.0 * d.worst / d.length,
      d.angle * 180.0 / M_PI);
}

TEST(CameraOdometry, FollowsADriveThroughTheMeetingRoom) {
  const World office = load_world("office_bare");
  const CameraRig rig(scene_of(office, 1.0), real());
  Pose start;
  start.position = {0.8, 6.8, 0.0};
  // Along the table and round its end.
  std::vector<Twist> twists(40, {Vector3d(0.5, 0, 0), 0.1});
  twists.insert(twists.end(), 40, {Vector3d(0.5, 0, 0), -0.1});
  twists.insert(twists.end(), 21, {Vector3d(0.4, 0, 0), 0.75});
  twists.insert(twists.end(), 25, {Vector3d(0.4, 0, 0), 0.0});
  const Drive d = drive(rig, start, twists);
  print("meeting room", d);
  EXPECT_EQ(d.ok, d.frames);
  EXPECT_LT(d.worst, 0.005 * d.length);
  EXPECT_LT(d.angle, 0.2 * M_PI / 180.0);
}

TEST(CameraOdometry, FollowsATurnInPlace) {
  const World office = load_world("office_bare");
  const CameraRig rig(scene_of(office, 1.0), real());
  Pose start;
  start.position = {4.9, 7.4, 0.0};
  const Drive d = drive(rig, start, std::vector<Twist>(60, {Vector3d::Zero(), 0.6}));
  std::printf("turn of %.2f rad: %d of %d frames ok, worst error %.1f mm, attitude %.3f deg\n",
              d.turned, d.ok, d.frames, 1e3 * d.worst, d.angle * 180.0 / M_PI);
  EXPECT_EQ(d.ok, d.frames);
  EXPECT_LT(d.worst, 0.005);
  EXPECT_LT(d.angle, 0.2 * M_PI / 180.0);
}

TEST(CameraOdometry, IsLostBeforeABlankWall) {
  const World room = test::box_room(8.0, 8.0, 3.0, 0.1, 40.0);
  Pose start;
  start.position = {6.6, 4.0, 0.9};  // nothing but the wall in view
  const std::vector<Twist> sideways(10, {Vector3d(0, 0.3, 0), 0.0});
  const CameraRig textured(scene_of(room, 1.0), real());
  const Drive seen = drive(textured, start, sideways);
  EXPECT_EQ(seen.state, Localization::kOk);
  const CameraRig blank(scene_of(room, 0.0), real());
  EXPECT_TRUE(detect_corners(blank.stereo(start, {}, 0).left.view()).empty());
  const Drive unseen = drive(blank, start, sideways);
  EXPECT_EQ(unseen.state, Localization::kLost);
  EXPECT_EQ(unseen.ok, 0);
}

}  // namespace
}  // namespace prospect::camera_odometry_test
