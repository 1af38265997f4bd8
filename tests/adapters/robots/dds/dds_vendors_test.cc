// SPDX-License-Identifier: Apache-2.0
// Fast DDS, which most robots with ROS 2 speak, as the other side: its own bytes (Fast CDR), its
// own discovery. Over the wire, as two vendors share no memory.
#include <gtest/gtest.h>

#ifdef PROSPECT_WITH_FASTDDS

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav2_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/robots/dds/dds_navigation.h"
#include "adapters/robots/dds/dds_node.h"
#include "tests/adapters/dds_pair.h"
#include "tests/adapters/fast_node.h"

namespace prospect::dds_vendors_test {
namespace {

using test::FastNode;
using test::kPatience;
using test::within;

TEST(DdsVendors, AnImageThatFastDdsWritesIsReadWhole) {
  DdsNode ours(test::dds_test_address());
  std::atomic<int> came = 0;
  std::vector<std::uint8_t> pixels(320 * 240 * 3);  // larger than a datagram
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(7 * i);
  ours.subscribe<ros::Image>("/left/image_raw", kSensorQos, [&](const ros::Image& m) {
    came += m.header.stamp.sec == 12 && m.header.stamp.nanosec == 34 &&
            m.header.frame_id == "left_optical" && m.width == 320 && m.height == 240 &&
            m.encoding == "rgb8" && m.step == 960 &&
            std::equal(m.data.begin(), m.data.end(), pixels.begin(), pixels.end());
  });
  ours.start();

  FastNode theirs(test::dds_test_address());
  const int image = theirs.advertise<ros::Image>("/left/image_raw", kReliableQos);
  eprosima::fastcdr::FastBuffer buffer;
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  cdr << std::int32_t{12} << std::uint32_t{34} << std::string("left_optical") << std::uint32_t{240}
      << std::uint32_t{320} << std::string("rgb8") << std::uint8_t{0} << std::uint32_t{960}
      << pixels;
  const std::string bytes(buffer.getBuffer(), cdr.getSerializedDataLength());
  ASSERT_TRUE(within(kPatience, [&] { return ours.publishers("/left/image_raw") == 1; }));
  EXPECT_TRUE(within(
      kPatience, [&] { return came > 0; }, [&] { theirs.publish(image, bytes); }));
  EXPECT_TRUE(ours.faults().empty());
}

TEST(DdsVendors, FastDdsReadsOurCommands) {
  DdsNode ours(test::dds_test_address());
  const int command = ours.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos);
  ours.start();
  std::mutex mutex;
  std::string bytes;
  FastNode theirs(test::dds_test_address());
  theirs.subscribe_bytes<ros::TwistStamped>("/cmd_vel", kCommandQos, [&](const std::string& cdr) {
    const std::lock_guard lock(mutex);
    bytes = cdr;
  });
  ros::TwistStamped m;
  m.header = {{12, 34}, "base_link"};
  m.twist.linear.x = 0.25;
  m.twist.angular.z = -0.5;
  const auto came = [&] {
    const std::lock_guard lock(mutex);
    return !bytes.empty();
  };
  ASSERT_TRUE(within(kPatience, came, [&] { ours.publish(command, m); }));
  const std::lock_guard lock(mutex);
  eprosima::fastcdr::FastBuffer buffer(bytes.data(), bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.read_encapsulation();
  std::int32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::string frame;
  double twist[6] = {};
  cdr >> seconds >> nanoseconds >> frame;
  for (double& value : twist) cdr >> value;
  EXPECT_EQ(seconds, 12);
  EXPECT_EQ(nanoseconds, 34u);
  EXPECT_EQ(frame, "base_link");
  EXPECT_EQ(twist[0], 0.25);
  EXPECT_EQ(twist[5], -0.5);
}

/// A client of the action NavigateToPose: bytes as rmw_cyclonedds sends them, by another's hands.
TEST(DdsVendors, AGoalOfTheActionIsTakenAndAnswered) {
  const DdsOptions options;
  const SteadyClock clock;
  DdsNode ours(test::dds_test_address("prospect"));
  const DdsTransforms transforms(ours);
  const DdsBase base(options, ours, transforms, clock);
  DriveRequests requests;
  const DdsNavigation navigation(options, ours, transforms, base, clock, requests);
  ours.start();

  FastNode theirs(test::dds_test_address());
  const std::string service = options.action + "/_action/send_goal";
  const int ask = theirs.advertise<ros::NavigateToPoseSendGoalRequest>(
      service, kReliableQos, "rq/prospect/navigate_to_pose/_action/send_goalRequest");
  std::mutex mutex;
  std::string bytes;
  theirs.subscribe_bytes<ros::NavigateToPoseSendGoalResponse>(
      service, kReliableQos,
      [&](const std::string& cdr) {
        const std::lock_guard lock(mutex);
        bytes = cdr;
      },
      "rr/prospect/navigate_to_pose/_action/send_goalReply");

  // Of a second goal with the number of the first the answer is no: each question is a new one.
  const auto question = [](std::int64_t number) {
    eprosima::fastcdr::FastBuffer buffer;
    eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                               eprosima::fastcdr::Cdr::DDS_CDR);
    cdr.serialize_encapsulation();
    cdr << std::uint64_t{0x0102030405060708} << number;  // who asks, and which question
    for (int n = 0; n < 16; ++n) cdr << static_cast<std::uint8_t>(n + number);
    cdr << std::int32_t{0} << std::uint32_t{0} << std::string("map") << 2.5 << -1.5 << 0.0 << 0.0
        << 0.0 << 1.0 << 0.0 << std::string("");
    return std::string(buffer.getBuffer(), cdr.getSerializedDataLength());
  };
  const auto came = [&] {
    const std::lock_guard lock(mutex);
    return !bytes.empty();
  };
  ASSERT_TRUE(within(kPatience, [&] { return theirs.connected(); }));
  int looked = 0;
  std::int64_t asked = 0;
  ASSERT_TRUE(within(kPatience, came, [&] {
    if (looked++ % 50 == 0) theirs.publish(ask, question(++asked));
  }));
  const auto place = requests.take_place();
  ASSERT_TRUE(place);
  EXPECT_EQ(place->position, Eigen::Vector2d(2.5, -1.5));
  EXPECT_NEAR(std::abs(place->yaw.value()), M_PI, 1e-9);

  const std::lock_guard lock(mutex);
  eprosima::fastcdr::FastBuffer answer(bytes.data(), bytes.size());
  eprosima::fastcdr::Cdr read(answer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                              eprosima::fastcdr::Cdr::DDS_CDR);
  read.read_encapsulation();
  std::uint64_t client = 0;
  std::int64_t number = 0;
  bool accepted = false;
  std::int32_t seconds = 0;
  read >> client >> number >> accepted >> seconds;
  EXPECT_EQ(client, 0x0102030405060708u);
  EXPECT_GE(number, 1);
  EXPECT_LE(number, asked);
  EXPECT_TRUE(accepted);
  EXPECT_GT(seconds, 1'600'000'000);  // of the time of day
  ours.stop();
}

}  // namespace
}  // namespace prospect::dds_vendors_test

#else

TEST(DdsVendors, AnotherVendorIsUnderstood) {
  GTEST_SKIP() << "Fast DDS is not installed (libfastrtps-dev)";
}

#endif
