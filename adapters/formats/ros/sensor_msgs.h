// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

struct RegionOfInterest {
  static constexpr const char* kType = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0;
  std::uint32_t y_offset = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  bool do_rectify = false;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("x_offset", m.x_offset);
    visit("y_offset", m.y_offset);
    visit("height", m.height);
    visit("width", m.width);
    visit("do_rectify", m.do_rectify);
  }
};

struct Image {
  static constexpr const char* kType = "sensor_msgs/msg/Image";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;
  std::span<const std::uint8_t> data;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("encoding", m.encoding);
    visit("is_bigendian", m.is_bigendian);
    visit("step", m.step);
    visit("data", m.data);
  }
};

struct CompressedImage {
  static constexpr const char* kType = "sensor_msgs/msg/CompressedImage";
  Header header;
  std::string format;
  std::span<const std::uint8_t> data;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("format", m.format);
    visit("data", m.data);
  }
};

struct CameraInfo {
  static constexpr const char* kType = "sensor_msgs/msg/CameraInfo";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k = {};
  std::array<double, 9> r = {};
  std::array<double, 12> p = {};
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  RegionOfInterest roi;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("distortion_model", m.distortion_model);
    visit("d", m.d);
    visit("k", m.k);
    visit("r", m.r);
    visit("p", m.p);
    visit("binning_x", m.binning_x);
    visit("binning_y", m.binning_y);
    visit("roi", m.roi);
  }
};

struct LaserScan {
  static constexpr const char* kType = "sensor_msgs/msg/LaserScan";
  Header header;
  float angle_min = 0.0F;
  float angle_max = 0.0F;
  float angle_increment = 0.0F;
  float time_increment = 0.0F;
  float scan_time = 0.0F;
  float range_min = 0.0F;
  float range_max = 0.0F;
  std::vector<float> ranges;
  std::vector<float> intensities;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("angle_min", m.angle_min);
    visit("angle_max", m.angle_max);
    visit("angle_increment", m.angle_increment);
    visit("time_increment", m.time_increment);
    visit("scan_time", m.scan_time);
    visit("range_min", m.range_min);
    visit("range_max", m.range_max);
    visit("ranges", m.ranges);
    visit("intensities", m.intensities);
  }
};

struct Imu {
  static constexpr const char* kType = "sensor_msgs/msg/Imu";
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance = {};
  Vector3 angular_velocity;
  std::array<double, 9> angular_velocity_covariance = {};
  Vector3 linear_acceleration;
  std::array<double, 9> linear_acceleration_covariance = {};

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("orientation", m.orientation);
    visit("orientation_covariance", m.orientation_covariance);
    visit("angular_velocity", m.angular_velocity);
    visit("angular_velocity_covariance", m.angular_velocity_covariance);
    visit("linear_acceleration", m.linear_acceleration);
    visit("linear_acceleration_covariance", m.linear_acceleration_covariance);
  }
};

struct PointField {
  static constexpr const char* kType = "sensor_msgs/msg/PointField";
  static constexpr std::uint8_t kFloat32 = 7, kFloat64 = 8;
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
  std::uint32_t count = 0;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("name", m.name);
    visit("offset", m.offset);
    visit("datatype", m.datatype);
    visit("count", m.count);
  }
};

struct PointCloud2 {
  static constexpr const char* kType = "sensor_msgs/msg/PointCloud2";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> point_fields;  ///< the standard calls it `fields`
  bool is_bigendian = false;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::span<const std::uint8_t> data;
  bool is_dense = false;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("fields", m.point_fields);
    visit("is_bigendian", m.is_bigendian);
    visit("point_step", m.point_step);
    visit("row_step", m.row_step);
    visit("data", m.data);
    visit("is_dense", m.is_dense);
  }
};

}  // namespace prospect::ros
