// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/robots/gazebo/messages.pb.h"

namespace prospect::gazebo_messages_test {
namespace {

using ::testing::ElementsAre;

void set_image(gazebo::msgs::Image* image, unsigned width, unsigned height, unsigned format,
               const std::string& data) {
  image->set_width(width);
  image->set_height(height);
  image->set_pixel_format(format);
  image->set_step(0);
  image->set_data(data);
}

std::string pair_of(unsigned format, const std::string& data, unsigned width = 2) {
  gazebo::msgs::ImagesStamped message;
  message.mutable_time()->set_sec(7);
  message.mutable_time()->set_nsec(250000000);
  for (int k = 0; k < 2; ++k) set_image(message.add_image(), width, 1, format, data);
  return message.SerializeAsString();
}

TEST(GazeboMessages, ColoursBecomeGreyByTheirWeights) {
  const std::string two("\xff\x00\x00\x00\x00\xff", 6);  // red and blue, where red comes first
  const GazeboPair rgb = read_gazebo_pair(pair_of(3, two));
  EXPECT_EQ(rgb.stamp, 7.25);
  EXPECT_THAT(rgb.images.left.pixels, ElementsAre(76, 29));
  EXPECT_THAT(rgb.images.right.pixels, ElementsAre(76, 29));
  EXPECT_THAT(read_gazebo_pair(pair_of(8, two)).images.left.pixels, ElementsAre(29, 76));
  EXPECT_THAT(read_gazebo_pair(pair_of(1, "\x05\x63")).images.left.pixels, ElementsAre(5, 99));
  const std::string white(8, '\xff');
  EXPECT_THAT(read_gazebo_pair(pair_of(4, white)).images.left.pixels, ElementsAre(255, 255));
}

// Drawn here, from the seed, the stamp and the camera: what Gazebo draws rests on no seed.
TEST(GazeboMessages, NoiseIsThatOfSeedStampAndCamera) {
  const auto noisy = [](double sigma, std::uint64_t seed, double stamp) {
    GazeboPair pair{stamp, {Image(64, 64), Image(64, 64)}};
    for (Image* const image : {&pair.images.left, &pair.images.right}) {
      std::fill(image->pixels.begin(), image->pixels.end(), std::uint8_t{100});
    }
    GazeboImageNoise{sigma, seed}.add(pair);
    return pair.images;
  };
  const ImagePair one = noisy(1.5, 1, 7.002);
  EXPECT_EQ(one.left.pixels, noisy(1.5, 1, 7.002).left.pixels);
  EXPECT_NE(one.left.pixels, one.right.pixels);
  EXPECT_NE(one.left.pixels, noisy(1.5, 2, 7.002).left.pixels);
  EXPECT_NE(one.left.pixels, noisy(1.5, 1, 7.004).left.pixels);
  double sum = 0.0, squares = 0.0;
  for (const std::uint8_t pixel : one.left.pixels) {
    sum += pixel - 100.0, squares += (pixel - 100.0) * (pixel - 100.0);
  }
  const auto n = static_cast<double>(one.left.pixels.size());
  EXPECT_NEAR(sum / n, 0.0, 0.1);
  EXPECT_NEAR(std::sqrt(squares / n), 1.5, 0.1);
  for (const std::uint8_t pixel : noisy(0.0, 1, 7.0).left.pixels) EXPECT_EQ(pixel, 100);
  for (const std::uint8_t pixel : noisy(50.0, 1, 7.0).left.pixels) EXPECT_LT(pixel, 100 + 3.6 * 50);
}

TEST(GazeboMessages, ImagesThatDoNotFitAreRefused) {
  EXPECT_THROW(read_gazebo_pair(pair_of(3, "short")), std::runtime_error);
  EXPECT_NO_THROW(read_gazebo_pair(pair_of(3, "longer")));
  EXPECT_THROW(read_gazebo_pair(pair_of(3, "longer", 3)), std::runtime_error);
  EXPECT_THROW(read_gazebo_pair(pair_of(3, "", 0)), std::runtime_error);
  EXPECT_THROW(read_gazebo_pair(pair_of(13, "12345678")), std::runtime_error);
  EXPECT_THROW(read_gazebo_pair(pair_of(1, "ab", 4000000000u)), std::runtime_error);
  EXPECT_THROW(read_gazebo_pair("no message"), std::runtime_error);
  gazebo::msgs::ImagesStamped lone;
  lone.mutable_time()->set_sec(0);
  lone.mutable_time()->set_nsec(0);
  set_image(lone.add_image(), 1, 1, 1, "a");
  EXPECT_THROW(read_gazebo_pair(lone.SerializeAsString()), std::runtime_error);
}

TEST(GazeboMessages, DepthsOutsideTheRangeAreNone) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> metres = {1.5f, inf, -inf, NAN, 0.1f, 9.0f};
  std::string data(metres.size() * sizeof(float), '\0');
  std::memcpy(data.data(), metres.data(), data.size());
  gazebo::msgs::ImageStamped message;
  message.mutable_time()->set_sec(1);
  message.mutable_time()->set_nsec(0);
  set_image(message.mutable_image(), 3, 2, 3, data);
  const DepthRange range{0.2, 8.0};
  const GazeboDepth depth = read_gazebo_depth(message.SerializeAsString(), range);
  EXPECT_EQ(depth.stamp, 1.0);
  ASSERT_EQ(depth.image.width, 3);
  EXPECT_EQ(depth.image.at(0, 0), 1.5f);
  for (int n = 1; n < 6; ++n) EXPECT_FALSE(range.holds(depth.image.at(n % 3, n / 3))) << n;
  message.mutable_image()->set_height(3);
  EXPECT_THROW(read_gazebo_depth(message.SerializeAsString(), range), std::runtime_error);
}

TEST(GazeboMessages, PosesAreChecked) {
  gazebo::msgs::PosesStamped message;
  message.mutable_time()->set_sec(2);
  message.mutable_time()->set_nsec(500000000);
  gazebo::msgs::Pose* const pose = message.add_pose();
  pose->set_name("robot");
  pose->mutable_position()->set_x(1.0);
  pose->mutable_position()->set_y(2.0);
  pose->mutable_position()->set_z(3.0);
  pose->mutable_orientation()->set_x(0.0);
  pose->mutable_orientation()->set_y(0.0);
  pose->mutable_orientation()->set_z(0.0);
  pose->mutable_orientation()->set_w(1.0);
  const GazeboPoses poses = read_gazebo_poses(message.SerializeAsString());
  EXPECT_EQ(poses.stamp, 2.5);
  ASSERT_NE(poses.find("robot"), nullptr);
  EXPECT_EQ(poses.find("robot")->position, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(poses.find("rob"), nullptr);
  pose->mutable_orientation()->set_w(0.0);
  EXPECT_THROW(read_gazebo_poses(message.SerializeAsString()), std::runtime_error);
  pose->mutable_orientation()->set_w(1.0);
  pose->mutable_position()->set_x(NAN);
  EXPECT_THROW(read_gazebo_poses(message.SerializeAsString()), std::runtime_error);
}

TEST(GazeboMessages, AVelocityIsAPoseWithTheYawTurned) {
  const auto yaw = [](double rate, bool turned) {
    gazebo::msgs::Pose pose;
    EXPECT_TRUE(pose.ParseFromString(gazebo_velocity({{0.4, 0.0, 0.0}, rate}, turned)));
    EXPECT_EQ(pose.position().x(), 0.4);
    return 2.0 * std::atan2(pose.orientation().z(), pose.orientation().w());
  };
  EXPECT_NEAR(yaw(0.7, true), -0.7, 1e-12);
  EXPECT_NEAR(yaw(0.7, false), 0.7, 1e-12);
  EXPECT_NEAR(yaw(5.0, false), 3.0, 1e-12);
  EXPECT_LT(std::abs(yaw(5.0, false)), std::numbers::pi);
}

}  // namespace
}  // namespace prospect::gazebo_messages_test
