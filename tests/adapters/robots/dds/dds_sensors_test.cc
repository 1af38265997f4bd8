// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_sensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/robots/dds/robot_with_cameras.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_sensors_test {
namespace {

using test::kPatience;
using test::within;
using ::testing::HasSubstr;

constexpr int kWidth = 32, kHeight = 24;

ros::CameraInfo camera_info(double offset) {
  ros::CameraInfo m;
  m.header.frame_id = "left_optical";
  m.width = kWidth;
  m.height = kHeight;
  m.distortion_model = "plumb_bob";
  m.d.assign(5, 0.0);
  m.k = {30.0, 0.0, 16.0, 0.0, 30.0, 12.0, 0.0, 0.0, 1.0};
  m.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  m.p = {30.0, 0.0, 16.0, -30.0 * offset, 0.0, 30.0, 12.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return m;
}

/// Cameras and a lidar at the other end.
struct Robot {
  explicit Robot(const DdsOptions& o) : node(test::dds_test_address("robot")) {
    infos = {node.advertise<ros::CameraInfo>(o.stereo.left_info, kSensorQos),
             node.advertise<ros::CameraInfo>(o.stereo.right_info, kReliableQos),
             node.advertise<ros::CameraInfo>(o.depth.info, kSensorQos)};
    left = node.advertise<ros::Image>(o.stereo.left, kSensorQos);
    right = node.advertise<ros::Image>(o.stereo.right, kReliableQos);
    depth = node.advertise<ros::Image>(o.depth.image, kSensorQos);
    scan = node.advertise<ros::LaserScan>(o.scan, kSensorQos);
    transforms = node.advertise<ros::TFMessage>("/tf_static", kLatchedQos);
    node.start();
  }
  void publish_infos() {
    node.publish(infos[0], camera_info(0.0));
    node.publish(infos[1], camera_info(0.1));
    node.publish(infos[2], camera_info(0.0));
  }
  void publish_transforms() {
    ros::TFMessage m;
    for (const char* child : {"left_optical", "lidar"}) {
      ros::TransformStamped t;
      t.header.frame_id = "base_link";
      t.child_frame_id = child;
      t.transform.translation = {0.1, 0.0, 0.4};
      // The lidar looks to the left.
      if (std::string(child) == "lidar") t.transform.rotation = {0.0, 0.0, M_SQRT1_2, M_SQRT1_2};
      m.transforms.push_back(t);
    }
    node.publish(transforms, m);
  }
  static ros::Image image(double stamp, const std::string& encoding, std::uint32_t pixel,
                          std::span<const std::uint8_t> data, int width = kWidth) {
    ros::Image m;
    m.header = {ros::time_of(stamp), "left_optical"};
    m.width = static_cast<std::uint32_t>(width);
    m.height = kHeight;
    m.encoding = encoding;
    m.step = static_cast<std::uint32_t>(width) * pixel;
    m.data = data;
    return m;
  }

  DdsNode node;
  std::array<int, 3> infos{};
  int left = -1, right = -1, depth = -1, scan = -1, transforms = -1;
};

DdsOptions options() {
  DdsOptions o;
  o.scan = "/scan";
  o.mounts_from_tf = true;
  o.timeout = 15.0;
  return o;
}

SensorInboxOptions same_clock() {
  SensorInboxOptions o;
  o.cameras_in_runtime_clock = o.depth_in_runtime_clock = o.scan_in_runtime_clock = true;
  return o;
}

TEST(DdsSensors, WithoutCalibrationNothingBeginsAndALineSaysWhatIsMissing) {
  DdsOptions o = options();
  o.timeout = 0.05;
  const SteadyClock clock;
  SensorInbox inbox(clock, same_clock());
  DdsNode node(test::dds_test_address("prospect"));
  DdsTransforms transforms(node);
  const DdsSensors sensors(o, node, transforms, inbox);
  node.start();
  try {
    sensors.wait();
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.lines().size(), 3u);
    EXPECT_EQ(error.lines()[0],
              "/left/camera_info: no message within 0.05 s; expected the left camera's calibration "
              "(sensor_msgs/msg/CameraInfo)");
  }
}

// A robot with a depth camera ahead, another behind it, and a lidar.
TEST(DdsSensors, EachDepthSensorHasItsNumberItsPlaceAndItsView) {
  DdsOptions o = options();
  o.scan.clear();
  o.stereo = {"", "", "", ""};
  o.pose_source = DdsOptions::PoseSource::kTf;
  o.more_depth.resize(2);
  o.more_depth[0].depth.image = "/rear/image_rect_raw";
  o.more_depth[0].depth.info = "/rear/camera_info";
  o.more_depth[1].scan = "/scan";
  const SteadyClock clock;
  SensorInbox inbox(clock, same_clock());
  DdsNode node(test::dds_test_address("prospect"));
  DdsTransforms transforms(node);
  const DdsSensors sensors(o, node, transforms, inbox);
  node.start();
  DdsNode robot(test::dds_test_address("robot"));
  const int infos[] = {robot.advertise<ros::CameraInfo>(o.depth.info, kSensorQos),
                       robot.advertise<ros::CameraInfo>(o.more_depth[0].depth.info, kSensorQos)};
  const int images[] = {robot.advertise<ros::Image>(o.depth.image, kSensorQos),
                        robot.advertise<ros::Image>(o.more_depth[0].depth.image, kSensorQos)};
  const int scans = robot.advertise<ros::LaserScan>("/scan", kSensorQos);
  const int places = robot.advertise<ros::TFMessage>("/tf_static", kLatchedQos);
  robot.start();
  ros::TFMessage tf;
  for (const auto& [child, x, half_yaw] : {std::tuple("left_optical", 0.1, 0.0),
                                           {"rear_optical", -0.1, M_PI_2},
                                           {"lidar", 0.0, 0.0}}) {
    ros::TransformStamped t;
    t.header.frame_id = "base_link";
    t.child_frame_id = child;
    t.transform.translation = {x, 0.0, 0.4};
    t.transform.rotation = {0.0, 0.0, std::sin(half_yaw), std::cos(half_yaw)};
    tf.transforms.push_back(t);
  }
  robot.publish(places, tf);
  ros::LaserScan scan;
  scan.angle_increment = 0.1F;
  scan.range_min = 0.1F;
  scan.range_max = 5.0F;
  scan.ranges = {2.0F};
  ros::CameraInfo rear = camera_info(0.0);
  rear.header.frame_id = "rear_optical";
  ASSERT_TRUE(within(
      kPatience, [&] { return inbox.count_of_sensor(2).received > 0; },
      [&] {
        robot.publish(infos[0], camera_info(0.0));
        robot.publish(infos[1], rear);
        scan.header = {ros::time_of(clock.now()), "lidar"};
        robot.publish(scans, scan);
      }));
  const DdsCameras cameras = sensors.wait();
  ASSERT_TRUE(cameras.depth);
  EXPECT_EQ(cameras.more_depth.at(1).width, kWidth);
  EXPECT_NEAR(cameras.more_mounts.at(1).T_BC.translation().x(), -0.1, 1e-12);
  EXPECT_NEAR(cameras.depth_mount->T_BC.translation().x(), 0.1, 1e-12);
  EXPECT_NEAR(cameras.more_lidars.at(2).max_range, 5.0, 1e-6);

  RobotDescription told;
  told.more_depth.resize(2);
  const RobotDescription robot_as_seen = robot_with(cameras, told);
  EXPECT_NEAR(robot_as_seen.more_depth[0].mount.T_BC.translation().x(), -0.1, 1e-12);
  EXPECT_EQ(robot_as_seen.more_depth[0].footprint.horizontal_fov,
            cameras.more_depth.at(1).horizontal_fov());
  EXPECT_EQ(robot_as_seen.more_depth[1].footprint.vertical_fov, 0.0);

  std::vector<std::uint8_t> depths(kWidth * kHeight * 2, 0);
  ASSERT_TRUE(within(
      kPatience,
      [&] {
        return inbox.count(SensorStream::kDepth).received > 0 &&
               inbox.count_of_sensor(1).received > 0;
      },
      [&] {
        const double now = clock.now();
        for (const int camera : {0, 1}) {
          depths[0] = 0xdc, depths[1] = static_cast<std::uint8_t>(0x05 + camera);
          ros::Image image = Robot::image(now, "16UC1", 2, depths);
          if (camera == 1) image.header.frame_id = "rear_optical";
          robot.publish(images[camera], image);
        }
      }));
  EXPECT_NEAR(inbox.ranges(0).depth.image->at(0, 0), 1.5F, 1e-6);
  EXPECT_NEAR(inbox.ranges(1).depth.image->at(0, 0), 1.756F, 1e-6);
  EXPECT_EQ(inbox.ranges(2).scan.in_B->origin.z(), 0.4);
}

// In the body's axes by tf; one of a frame that tf does not know says nothing, and is named.
TEST(DdsSensors, AnImuGoesIntoTheInboxWithItsAxes) {
  DdsOptions o = options();
  o.imu = "/imu/data";
  const SteadyClock clock;
  SensorInbox inbox(clock, in_runtime_clock(SensorInboxOptions()));
  DdsNode node(test::dds_test_address("prospect"));
  DdsTransforms transforms(node);
  const DdsSensors sensors(o, node, transforms, inbox);
  node.start();
  Robot robot(o);
  DdsNode other(test::dds_test_address("imu"));
  const int topic = other.advertise<ros::Imu>(o.imu, kSensorQos);
  other.start();
  const auto told = [&](const char* frame, double rate) {
    ros::Imu m;
    m.header = {ros::time_of(clock.now()), frame};
    m.angular_velocity = {rate, 0.0, 0.5};
    other.publish(topic, m);
  };
  EXPECT_TRUE(within(
      kPatience, [&] { return !node.fault(o.imu).empty(); }, [&] { told("nowhere", 0.0); }));
  EXPECT_THAT(node.fault(o.imu), HasSubstr("no transform from 'nowhere' to 'base_link'"));
  EXPECT_EQ(inbox.count(SensorStream::kImu).received, 0u);
  ASSERT_TRUE(within(
      kPatience, [&] { return !inbox.imu_since(0.0).empty(); },
      [&] {
        robot.publish_transforms();
        told("lidar", 0.3);
      }));
  const ImuSample turned = inbox.imu_since(0.0).back();
  EXPECT_EQ(turned.yaw_rate(), 0.5);
  EXPECT_NEAR((turned.R_BS * turned.angular_velocity).y(), 0.3, 1e-6) << "it looks to the left";
  ASSERT_TRUE(within(
      kPatience, [&] { return inbox.imu_since(0.0).back().R_BS.w() == 1.0; },
      [&] { told("base_link", 0.3); }));
}

TEST(DdsSensors, ImagesDepthsAndScansGoIntoTheInbox) {
  const DdsOptions o = options();
  const SteadyClock clock;
  SensorInbox inbox(clock, same_clock());
  DdsNode node(test::dds_test_address("prospect"));
  DdsTransforms transforms(node);
  const DdsSensors sensors(o, node, transforms, inbox);
  node.start();
  Robot robot(o);
  robot.publish_transforms();
  ASSERT_TRUE(within(kPatience, [&] {
    return robot.node.subscribers(o.stereo.left_info) > 0 &&
           robot.node.subscribers(o.stereo.right_info) > 0 &&
           robot.node.subscribers(o.depth.info) > 0;
  }));
  robot.publish_infos();
  const DdsCameras cameras = sensors.wait();
  EXPECT_EQ(cameras.stereo->left.fx, 30.0);
  EXPECT_NEAR(cameras.stereo->baseline, 0.1, 1e-12);
  EXPECT_EQ(cameras.depth->width, kWidth);
  EXPECT_NEAR(cameras.stereo_mount->T_BC.translation().z(), 0.4, 1e-12);

  // Colours become grey: red 100 is 30.
  std::vector<std::uint8_t> red(kWidth * kHeight * 3, 0);
  for (std::size_t i = 0; i < red.size(); i += 3) red[i] = 100;
  std::vector<std::uint8_t> depths(kWidth * kHeight * 2, 0);
  depths[0] = 0xdc, depths[1] = 0x05;  // 1500 mm
  ASSERT_TRUE(within(kPatience, [&] {
    return robot.node.subscribers(o.stereo.left) > 0 && robot.node.subscribers(o.depth.image) > 0 &&
           robot.node.subscribers(o.stereo.right) > 0 && robot.node.subscribers(o.scan) > 0;
  }));
  const double now = clock.now();
  robot.node.publish(robot.left, Robot::image(now, "rgb8", 3, red));
  robot.node.publish(robot.right, Robot::image(now, "mono8", 1, std::span(red).first(768)));
  robot.node.publish(robot.depth, Robot::image(now, "16UC1", 2, depths));
  ros::LaserScan scan;
  scan.header = {ros::time_of(now), "lidar"};
  scan.angle_increment = 0.1F;
  scan.range_min = 0.1F;
  scan.range_max = 5.0F;
  scan.ranges = {2.0F};
  robot.node.publish(robot.scan, scan);
  ASSERT_TRUE(within(kPatience, [&] {
    return inbox.count(SensorStream::kPair).received == 1 &&
           inbox.count(SensorStream::kDepth).received == 1 &&
           inbox.count(SensorStream::kScan).received == 1;
  }));
  for (int n = 0; n < 3; ++n) {
    const std::optional<SensorFrame> frame = inbox.take();
    ASSERT_TRUE(frame);
    if (const auto* pair = std::get_if<StereoFrame>(&*frame)) {
      EXPECT_NEAR(pair->left_stamp, now, 1e-8);
      EXPECT_EQ(pair->left->at(5, 5), 30);
      EXPECT_EQ(pair->right->at(0, 0), 100);
    }
  }
  EXPECT_EQ(inbox.ranges().depth.image->at(0, 0), 1.5F);
  ASSERT_EQ(inbox.ranges().scan.in_B->hits.size(), 1u);
  EXPECT_LT((inbox.ranges().scan.in_B->hits[0] - Eigen::Vector3d(0.1, 2.0, 0.4)).norm(), 1e-6);

  // What does not fit is left out, and named.
  struct Row {
    ros::Image image;
    const char* expected;
  };
  ros::Image of_another = Robot::image(now, "mono8", 1, std::span(red).first(768));
  of_another.header.frame_id = "rear";
  const Row rows[] = {
      {of_another, "an image of frame 'rear'; expected 'left_optical' of its camera_info"},
      {Robot::image(now, "mono8", 1, red, 16), "16 x 24 pixels; expected 32 x 24"},
      {Robot::image(now, "nv21", 1, red), "images in encoding 'nv21'"},
      {Robot::image(now, "rgb8", 3, depths), "expected all of its rows"}};
  for (const Row& row : rows) {
    EXPECT_TRUE(within(
        kPatience,
        [&] { return node.fault(o.stereo.left).find(row.expected) != std::string::npos; },
        [&] { robot.node.publish(robot.left, row.image); }))
        << row.expected;
  }
  scan.header.frame_id = "sonar";
  EXPECT_TRUE(within(
      kPatience, [&] { return !node.fault(o.scan).empty(); },
      [&] { robot.node.publish(robot.scan, scan); }));
  EXPECT_THAT(node.fault(o.scan), HasSubstr("no transform from 'sonar' to 'base_link'"));
  EXPECT_EQ(inbox.count(SensorStream::kLeft).received, 1u);

  // A calibration that changes takes the camera's images with it, until it is back.
  const ros::Image grey = Robot::image(now + 1.0, "mono8", 1, std::span(red).first(768));
  ros::CameraInfo zoomed = camera_info(0.0);
  zoomed.k[0] = zoomed.p[0] = 31.0;
  EXPECT_TRUE(within(
      kPatience,
      [&] {
        return node.fault(o.stereo.left_info).find("another calibration") != std::string::npos;
      },
      [&] { robot.node.publish(robot.infos[0], zoomed); }));
  EXPECT_TRUE(within(
      kPatience,
      [&] { return node.fault(o.stereo.left).find("of another calibration") != std::string::npos; },
      [&] { robot.node.publish(robot.left, grey); }));
  EXPECT_EQ(inbox.count(SensorStream::kLeft).received, 1u);
  EXPECT_TRUE(within(
      kPatience, [&] { return node.fault(o.stereo.left_info).empty(); },
      [&] { robot.node.publish(robot.infos[0], camera_info(0.0)); }));
  robot.node.publish(robot.left, grey);
  EXPECT_TRUE(within(kPatience, [&] { return inbox.count(SensorStream::kLeft).received == 2; }));
}

}  // namespace
}  // namespace prospect::dds_sensors_test
