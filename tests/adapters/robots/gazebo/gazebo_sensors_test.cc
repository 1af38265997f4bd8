// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_sensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <string>
#include <variant>

#include "adapters/robots/gazebo/gazebo_truth.h"
#include "runtime/sensor_inbox.h"
#include "tests/adapters/fake_gazebo.h"

namespace prospect::gazebo_sensors_test {
namespace {

using test::FakeGazebo;
using test::soon;
using ::testing::HasSubstr;

const std::string kStereo = "/gazebo/room/robot/base/stereo/images";
const std::string kDepth = "/gazebo/room/robot/base/depth/image";
const std::string kRear = "/gazebo/room/robot/base/depth_1/image";

void fill(gazebo::msgs::Image* image, unsigned format, const std::string& data) {
  image->set_width(2);
  image->set_height(1);
  image->set_pixel_format(format);
  image->set_step(0);
  image->set_data(data);
}

TEST(GazeboSensors, PutsPairsAndDepthsIntoTheInbox) {
  FakeGazebo gazebo;
  const SteadyClock machine;
  SimulationClock clock(machine);
  SensorInboxOptions own_clock;
  own_clock.cameras_in_runtime_clock = true;
  own_clock.depth_in_runtime_clock = true;
  SensorInbox inbox(clock, own_clock);
  GazeboOptions options = gazebo.options();
  options.image_noise = 0.0;
  options.depth_sensors = 2;
  const GazeboSensors sensors(options, clock, inbox);
  ASSERT_TRUE(soon([&] {
    return gazebo.subscribers(kStereo) == 1 && gazebo.subscribers(kDepth) == 1 &&
           gazebo.subscribers(kRear) == 1 && sensors.connected();
  }));
  gazebo::msgs::ImagesStamped pair;
  FakeGazebo::stamp(pair, 1000.0);
  fill(pair.add_image(), 1, "ab");
  fill(pair.add_image(), 1, "cd");
  gazebo.publish(kStereo, pair);
  ASSERT_TRUE(soon([&] { return inbox.count(SensorStream::kPair).received == 1; }));
  const auto frame = inbox.take();
  ASSERT_TRUE(frame && std::holds_alternative<StereoFrame>(*frame))
      << inbox.count(SensorStream::kPair).reason;
  EXPECT_EQ(std::get<StereoFrame>(*frame).left->at(1, 0), 'b');
  EXPECT_EQ(std::get<StereoFrame>(*frame).right->at(0, 0), 'c');

  const float metres[] = {1.0f, 2.0f};
  gazebo::msgs::ImageStamped depth;
  FakeGazebo::stamp(depth, 1000.05);
  fill(depth.mutable_image(), 3, std::string(reinterpret_cast<const char*>(metres), 8));
  gazebo.publish(kDepth, depth);
  ASSERT_TRUE(soon([&] { return inbox.ranges().depth.image != nullptr; }));
  EXPECT_EQ(inbox.ranges().depth.image->at(1, 0), 2.0f);
  EXPECT_EQ(inbox.ranges().depth.stamp, 1000.05);  // the simulation's time is the runtime's
  EXPECT_GE(clock.now(), 1000.05);
  gazebo.publish(kRear, depth);
  ASSERT_TRUE(soon([&] { return inbox.ranges(1).depth.image != nullptr; }));
  EXPECT_EQ(inbox.ranges(1).depth.image->at(1, 0), 2.0f);
  EXPECT_TRUE(sensors.faults().empty());

  gazebo.publish(kDepth, std::string("no image"));
  ASSERT_TRUE(soon([&] { return !sensors.faults().empty(); }));
  EXPECT_THAT(sensors.faults().front(), HasSubstr("bytes that are no ImageStamped"));
  gazebo.end();
  EXPECT_TRUE(soon([&] { return !sensors.connected(); }));
}

TEST(GazeboSensors, AnImuThatTheRobotHasGoesIntoTheInbox) {
  FakeGazebo gazebo;
  const SteadyClock machine;
  SimulationClock clock(machine);
  SensorInbox inbox(clock, in_runtime_clock({}));
  GazeboOptions options = gazebo.options();
  options.imu = "imu";
  const std::string topic = "/gazebo/room/robot/base/imu/imu";
  const GazeboSensors sensors(options, clock, inbox);
  ASSERT_TRUE(soon([&] { return gazebo.subscribers(topic) == 1 && sensors.connected(); }));
  gazebo::msgs::IMU sample;
  sample.mutable_stamp()->set_sec(7);
  sample.mutable_stamp()->set_nsec(250'000'000);
  for (auto* v : {sample.mutable_angular_velocity(), sample.mutable_linear_acceleration()}) {
    v->set_x(0.1), v->set_y(0.2), v->set_z(0.3);
  }
  gazebo.publish(topic, sample);
  ASSERT_TRUE(soon([&] { return inbox.count(SensorStream::kImu).received == 1; }));
  const std::vector<ImuSample> came = inbox.imu_since(0.0);
  ASSERT_EQ(came.size(), 1u);
  EXPECT_EQ(came[0].stamp, 7.25);
  EXPECT_EQ(came[0].yaw_rate(), 0.3);
  EXPECT_EQ(came[0].linear_acceleration, Eigen::Vector3d(0.1, 0.2, 0.3));
  sample.mutable_angular_velocity()->set_z(std::nan(""));
  gazebo.publish(topic, sample);
  ASSERT_TRUE(soon([&] { return !sensors.faults().empty(); }));
  EXPECT_THAT(sensors.faults().front(), HasSubstr("not finite"));
}

TEST(GazeboTruth, GivesEachPoseOnce) {
  FakeGazebo gazebo;
  GazeboTruth truth(gazebo.options());
  const std::string topic = "/gazebo/room/pose/info";
  ASSERT_TRUE(soon([&] { return gazebo.subscribers(topic) == 1; }));
  gazebo::msgs::PosesStamped message;
  FakeGazebo::stamp(message, 3.5);
  gazebo::msgs::Pose* const pose = message.add_pose();
  pose->set_name("robot");
  pose->mutable_position()->set_x(1.0);
  pose->mutable_position()->set_y(-2.0);
  pose->mutable_position()->set_z(0.0);
  pose->mutable_orientation()->set_x(0.0);
  pose->mutable_orientation()->set_y(0.0);
  pose->mutable_orientation()->set_z(std::sin(0.25));
  pose->mutable_orientation()->set_w(std::cos(0.25));
  gazebo.publish(topic, message);
  std::deque<GazeboTruth::Stamped> poses;
  ASSERT_TRUE(soon([&] { return !(poses = truth.take()).empty(); }));
  EXPECT_EQ(poses.front().stamp, 3.5);
  EXPECT_EQ(poses.front().pose.position.y(), -2.0);
  EXPECT_NEAR(poses.front().pose.yaw, 0.5, 1e-12);
  EXPECT_TRUE(truth.take().empty());
}

}  // namespace
}  // namespace prospect::gazebo_sensors_test
