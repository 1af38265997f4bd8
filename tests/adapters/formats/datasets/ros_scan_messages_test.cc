// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/ros_scan_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "adapters/formats/files/input_error.h"
#include "tests/adapters/lidar_recording.h"

namespace prospect::ros_scan_messages_test {
namespace {

using test::CdrWriter;
using test::LidarRecording;
using ::testing::HasSubstr;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename Read>
std::string refusal(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    return error.what();
  }
  return "accepted";
}

TEST(RosScanMessages, BeamsOfALaserScan) {
  const std::vector<float> ranges = {2.0F, kInf, kNan, 0.05F, 12.0F, 13.0F, -kInf, 0.0F};
  const RosLaserScan scan =
      read_ros_laser_scan(LidarRecording::scan_message(5, ranges, 0.001F), "m");
  EXPECT_FLOAT_EQ(static_cast<float>(scan.time_increment), 0.001F);
  EXPECT_EQ(scan.ranges.size(), 8u);
  const DepthScan rays = rays_of(scan);
  ASSERT_EQ(rays.hits.size(), 1u) << "too near, too far, nan, 0 and -inf say nothing";
  EXPECT_LT((rays.hits[0] - Eigen::Vector3d(-2.0, 0.0, 0.0)).norm(), 1e-5);
  ASSERT_EQ(rays.misses.size(), 2u) << "inf and the end of the range";
  EXPECT_LT(
      (rays.misses[0].normalized() - Eigen::Vector3d(-std::sqrt(0.5), -std::sqrt(0.5), 0.0)).norm(),
      1e-5);
}

TEST(RosScanMessages, BeamsOfALidarThatMoves) {
  const std::vector<float> ranges(5, 2.0F);
  const RosLaserScan scan = read_ros_laser_scan(LidarRecording::scan_message(5, ranges), "m");
  const Eigen::Isometry3d T_end = LidarRecording::at(0.4, 0.0, 0.0, 0.2);
  const DepthScan still = rays_of(scan), moved = rays_of(scan, T_end);
  EXPECT_LT((moved.hits[0] - still.hits[0]).norm(), 1e-12);
  EXPECT_LT((moved.hits[4] - T_end * still.hits[4]).norm(), 1e-12);
  EXPECT_LT((moved.hits[2] - LidarRecording::at(0.2, 0.0, 0.0, 0.1) * still.hits[2]).norm(), 1e-12);
}

TEST(RosScanMessages, ScansThatCannotBe) {
  const std::string whole = LidarRecording::scan_message(5, {1.0F, 2.0F, 3.0F});
  for (std::size_t size = 0; size + 8 < whole.size(); ++size) {
    EXPECT_THROW(read_ros_laser_scan(whole.substr(0, size), "m"), InputError) << size;
  }
  EXPECT_THAT(refusal([] {
                read_ros_laser_scan(LidarRecording::scan_message(5, {1.0F}, 0.0F, 0.05F),
                                    "/scan 3");
              }),
              HasSubstr("/scan 3: range_min 0.1"));
  EXPECT_THAT(refusal([] {
                read_ros_laser_scan(LidarRecording::scan_message(5, {1.0F}, 0.0F, kNan), "m");
              }),
              HasSubstr("range_max"));
  CdrWriter w;
  w.header(5, "laser");
  for (const float v : {0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.1F, 9.0F}) w.number(v);
  w.number(std::uint32_t{2}).number(1.0F).number(1.0F).number(std::uint32_t{0});
  EXPECT_THAT(refusal([&] { read_ros_laser_scan(w.str(), "m"); }), HasSubstr("angles of a scan"));
}

struct CloudField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t type = 7;
};

std::string cloud(std::uint32_t height, std::uint32_t width, const std::vector<CloudField>& fields,
                  std::uint32_t point_step, std::uint32_t row_step, const std::string& data,
                  bool big_endian = false) {
  CdrWriter w;
  w.header(5, "lidar").number(height).number(width);
  w.number(static_cast<std::uint32_t>(fields.size()));
  for (const CloudField& f : fields) {
    w.text(f.name).number(f.offset).number(f.type).number(std::uint32_t{1});
  }
  w.number(static_cast<std::uint8_t>(big_endian)).number(point_step).number(row_step);
  return w.bytes(data).number(std::uint8_t{0}).str();
}

template <typename Number>
void put(std::string& data, std::size_t at, Number value) {
  std::memcpy(data.data() + at, &value, sizeof value);
}

TEST(RosScanMessages, PointsOfClouds) {
  // Two rows of two points, 24 bytes a point, 4 bytes of padding a row, z before x.
  std::string data(2 * 52, '\x7f');
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t at = i / 2 * 52 + i % 2 * 24;
    put(data, at + 4, 10.0F + static_cast<float>(i));
    put(data, at + 8, 1.0F + static_cast<float>(i));
    put(data, at + 12, -2.0F);
  }
  put(data, 24 + 8, kNan);  // the second has no x
  const std::vector<CloudField> fields = {
      {"z", 4}, {"x", 8}, {"y", 12}, {"intensity", 16, 2}, {"ring", 20, 4}};
  const auto points = read_ros_point_cloud(cloud(2, 2, fields, 24, 52, data), "m");
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0], Eigen::Vector3d(1, -2, 10));
  EXPECT_EQ(points[1], Eigen::Vector3d(3, -2, 12));
  EXPECT_EQ(points[2], Eigen::Vector3d(4, -2, 13));
  // Doubles; a point at the origin is none.
  std::string wide(48, '\0');
  for (std::size_t i = 0; i < 3; ++i) put(wide, 8 * i, 0.5 + static_cast<double>(i));
  const std::vector<CloudField> doubles = {{"x", 0, 8}, {"y", 8, 8}, {"z", 16, 8}};
  const auto two = read_ros_point_cloud(cloud(1, 2, doubles, 24, 48, wide), "m");
  ASSERT_EQ(two.size(), 1u);
  EXPECT_EQ(two[0], Eigen::Vector3d(0.5, 1.5, 2.5));
  EXPECT_TRUE(read_ros_point_cloud(cloud(1, 0, {}, 0, 0, ""), "m").empty());
}

TEST(RosScanMessages, CloudsThatCannotBe) {
  const std::vector<CloudField> xyz = {{"x", 0}, {"y", 4}, {"z", 8}};
  const std::string data(24, '\x3f');
  struct Row {
    std::string bytes, expected;
  };
  for (const Row& row : std::vector<Row>{
           {cloud(1, 2, xyz, 12, 24, data, true), "big-endian"},
           {cloud(1, 2, {{"x", 0}, {"y", 4}}, 12, 24, data), "fields x, y; expected x, y and z"},
           {cloud(1, 2, {{"x", 0}, {"y", 4, 5}, {"z", 8}}, 12, 24, data), "field y is of type 5"},
           {cloud(1, 2, {{"x", 0}, {"y", 4}, {"z", 10}}, 12, 24, data), "field z at byte 10"},
           {cloud(1, 3, xyz, 12, 36, data), "expected all of them"},
           {cloud(2, 1, xyz, 12, 11, data), "expected all of them"},
           {cloud(4000000000U, 4000000000U, xyz, 12, 4000000000U, data), "expected all of them"},
           {cloud(2, 1, xyz, 12, 4000000000U, data), "expected all of them"}}) {
    EXPECT_THAT(refusal([&] { read_ros_point_cloud(row.bytes, "m"); }), HasSubstr(row.expected));
  }
  const std::string whole = cloud(1, 2, xyz, 12, 24, data);
  for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
    EXPECT_THROW(read_ros_point_cloud(whole.substr(0, size), "m"), InputError) << size;
  }
}

}  // namespace
}  // namespace prospect::ros_scan_messages_test
