// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/ros/cdr.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/octomap_msgs.h"
#include "adapters/formats/ros/rcl_interfaces.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/formats/ros/visualization_msgs.h"
#include "tests/adapters/filled_message.h"
#include "tests/adapters/ros_bag_writer.h"

namespace prospect::cdr_test {
namespace {

using ::testing::HasSubstr;

template <typename T>
class Cdr : public ::testing::Test {};
using All =
    ::testing::Types<ros::Bool, ros::String, ros::TwistStamped, ros::TransformStamped, ros::Image,
                     ros::CompressedImage, ros::CameraInfo, ros::LaserScan, ros::PointCloud2,
                     ros::Odometry, ros::Path, ros::OccupancyGrid, ros::TFMessage,
                     ros::DiagnosticArray, ros::Octomap, ros::Log, ros::MarkerArray>;
TYPED_TEST_SUITE(Cdr, All);

TYPED_TEST(Cdr, WhatIsWrittenIsReadAndNothingLessWillDo) {
  const auto message = test::filled<TypeParam>();
  const std::string bytes = ros::to_cdr(message);
  EXPECT_EQ(ros::to_cdr(ros::from_cdr<TypeParam>(bytes, "m")), bytes);
  EXPECT_NE(ros::to_cdr(TypeParam()), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(ros::from_cdr<TypeParam>(bytes.substr(0, size), "m"), InputError) << size;
  }
}

TEST(CdrBytes, AreThoseOfTheStandard) {
  // An odd frame name puts what follows off its alignment.
  ros::Odometry message;
  message.header = {{5, 7}, "map"};
  message.child_frame_id = "base_link";
  message.pose.pose.position = {1.0, 2.0, 3.0};
  message.pose.covariance[35] = 0.25;
  message.twist.twist.linear.x = 0.5;
  std::vector<double> numbers = {1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0};
  numbers.resize(7 + 36 + 6 + 36, 0.0);
  numbers[7 + 35] = 0.25;
  numbers[7 + 36] = 0.5;
  test::CdrWriter expected;
  expected.header(5'000'000'007, "map").text("base_link").doubles(numbers);
  EXPECT_EQ(ros::to_cdr(message), expected.str());
}

TEST(CdrBytes, OfTheOtherByteOrder) {
  // 0x00 0x00: big-endian.
  const std::string bytes("\0\0\0\0\0\0\0\5\0\0\0\7\0\0\0\2m\0", 18);
  const auto header = ros::from_cdr<ros::Header>(bytes, "m");
  EXPECT_EQ(header.stamp.sec, 5);
  EXPECT_EQ(header.stamp.nanosec, 7u);
  EXPECT_EQ(header.frame_id, "m");
}

TEST(CdrBytes, ACountThatClaimsMoreThanThereIsTakesNoMemory) {
  test::CdrWriter scan;
  scan.header(0, "m");
  for (int i = 0; i < 7; ++i) scan.number(1.0F);
  scan.number(std::uint32_t{0xffffffff});
  try {
    ros::from_cdr<ros::LaserScan>(scan.str(), "scan");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("scan: the message ends early"));
  }
  test::CdrWriter path;
  path.header(0, "m").number(std::uint32_t{0xffffffff});
  EXPECT_THROW(ros::from_cdr<ros::Path>(path.str(), "m"), InputError);
}

TEST(RosTime, IsExactAndWhatItCannotHoldIsNotSet) {
  EXPECT_EQ(ros::time_of(1.25).sec, 1);
  EXPECT_EQ(ros::time_of(1.25).nanosec, 250'000'000u);
  EXPECT_EQ(ros::time_of(-0.25).sec, -1);
  EXPECT_EQ(ros::time_of(-0.25).nanosec, 750'000'000u);
  EXPECT_EQ(ros::seconds(ros::time_of(-0.25)), -0.25);
  EXPECT_EQ(ros::time_of(0.9999999999).sec, 1);
  for (const double no : {std::nan(""), HUGE_VAL, 1e12, -1e12}) {
    EXPECT_EQ(ros::time_of(no).sec, 0);
    EXPECT_EQ(ros::time_of(no).nanosec, 0u);
  }
}

}  // namespace
}  // namespace prospect::cdr_test
