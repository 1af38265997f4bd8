// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/imu_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "tests/adapters/ros_bag_writer.h"

namespace prospect::imu_recording_test {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kSensor =
    "#IMU\nsensor_type: imu\ncomment: x\nT_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [0.0, -1.0, 0.0, 0.1,\n         1.0, 0.0, 0.0, 0.2,\n         0.0, 0.0, 1.0, 0.3,\n"
    "         0.0, 0.0, 0.0, 1.0]\nrate_hz: 200\ngyroscope_noise_density: 1.7e-4\n";

class ImuRecordingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = (fs::temp_directory_path() / ("prospect imu " + std::to_string(::getpid()))).string();
    fs::remove_all(folder_);
    fs::create_directories(folder_ + "/imu0");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << text;
  }
  std::string folder_;
  std::vector<std::string> notes_;
};

TEST_F(ImuRecordingTest, OfEuroc) {
  write("imu0/sensor.yaml", kSensor);
  write("imu0/data.csv",
        "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n"
        "1403715273262142976,-0.1,0.2,0.3,8.1,-0.3,-2.4\n"
        "1403715273267142976,nan,0.2,0.3,8.1,-0.3,-2.4\n"
        "1403715273272142976,-0.1,0.2,0.4,8.1,-0.3,-2.4\n");
  const ImuRecording imu = read_euroc_imu(folder_, 1e-9, notes_);
  ASSERT_EQ(imu.samples.size(), 2U);
  EXPECT_NEAR(imu.samples[0].stamp, 1403715273.262142976, 1e-6);
  EXPECT_EQ(imu.samples[1].angular_velocity, Eigen::Vector3d(-0.1, 0.2, 0.4));
  EXPECT_EQ(imu.samples[1].linear_acceleration, Eigen::Vector3d(8.1, -0.3, -2.4));
  EXPECT_TRUE((imu.samples[0].R_BS * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("1 of 3 samples")));
}

TEST_F(ImuRecordingTest, OneThatCannotBeUsedIsLeftOutAndSaidSo) {
  EXPECT_TRUE(read_euroc_imu(folder_, 1e-9, notes_).samples.empty());
  EXPECT_TRUE(notes_.empty());  // there is none
  write("imu0/data.csv", "1403715273262142976,-0.1,0.2,0.3,8.1,-0.3,-2.4\n");
  EXPECT_TRUE(read_euroc_imu(folder_, 1e-9, notes_).samples.empty());
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("the IMU is left out")));
  notes_.clear();
  write("imu0/sensor.yaml", kSensor);
  write("imu0/data.csv", "1403715273262142976,1,2,3\n1403715273262142977,1,2,3\n");
  EXPECT_TRUE(read_euroc_imu(folder_, 1e-9, notes_).samples.empty());
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("data.csv:1: not a sample")));
}

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;  // [ns]

std::string sample(std::int64_t t, const std::string& frame, double w, double a) {
  ros::Imu message;
  message.header.stamp.sec = static_cast<std::int32_t>(t / 1'000'000'000);
  message.header.stamp.nanosec = static_cast<std::uint32_t>(t % 1'000'000'000);
  message.header.frame_id = frame;
  message.angular_velocity = {w, 0.0, 0.0};
  message.linear_acceleration = {0.0, 0.0, a};
  return ros::to_cdr(message);
}

TEST_F(ImuRecordingTest, OfABagByTypeOrTopicAndTheAxesByTf) {
  Eigen::Isometry3d T_BC = Eigen::Isometry3d::Identity();
  T_BC.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  std::vector<test::BagMessage> messages = {{"/tf_static", "tf2_msgs/msg/TFMessage", kStart,
                                             test::CdrWriter()
                                                 .number(std::uint32_t{1})
                                                 .header(kStart, "base_link")
                                                 .text("left")
                                                 .pose(T_BC)
                                                 .str()}};
  const double odd = 0.1 + 1e-17 / 3.0;  // all of its bits
  for (int k = 0; k < 5; ++k) {
    messages.push_back({"/imu", ros::Imu::kType, kStart + 5'000'000LL * k,
                        sample(kStart + 5'000'000LL * k, "base_link", odd * (k + 1), 9.8)});
  }
  messages.push_back({"/other", ros::Imu::kType, kStart, sample(kStart, "nowhere", 0.3, 9.8)});
  const auto checksum = [](const std::string& records) -> std::uint64_t {
    return ::crc32(0, reinterpret_cast<const Bytef*>(records.data()),
                   static_cast<uInt>(records.size()));
  };
  write("a.mcap", test::mcap_of(
                      messages, 0, "", [](const std::string& r) { return r; }, checksum));
  const std::string path = folder_ + "/a.mcap";
  const BagFile bag = BagFile::open(path);
  const ImuRecording imu = read_bag_imu(bag, path, {}, "left", notes_);
  ASSERT_EQ(imu.samples.size(), 5U);
  EXPECT_EQ(imu.from, "/imu");
  for (int k = 0; k < 5; ++k) {  // to the last bit
    EXPECT_EQ(imu.samples[static_cast<std::size_t>(k)].angular_velocity.x(), odd * (k + 1));
  }
  // Forward in B is along the camera's axis.
  EXPECT_TRUE((imu.samples[0].R_BS * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_THAT(notes_, Contains(HasSubstr("topic imu=/imu, by its type; not used: /other")));
  notes_.clear();
  EXPECT_TRUE(read_bag_imu(bag, path, {{"imu", "/other"}}, "left", notes_).samples.empty());
  EXPECT_THAT(notes_, Contains(HasSubstr("no static transform leads from its frame 'nowhere'")));
  EXPECT_THROW(read_bag_imu(bag, path, {{"imu", "/tf_static"}}, "left", notes_), InputError);
}

}  // namespace
}  // namespace prospect::imu_recording_test
