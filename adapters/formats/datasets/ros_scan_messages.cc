// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/ros_scan_messages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/sensor_msgs.h"

namespace prospect {
namespace {

constexpr double kLongestScan = 10.0;  // [s]
constexpr double kAtTheEnd = 1e-3;     // [m]
constexpr double kAtTheOrigin = 1e-6;  // [m]

struct Field {
  std::uint32_t offset = 0;
  std::uint8_t type = 0;
  std::uint32_t count = 0;
  bool there = false;
  std::size_t size() const { return type == ros::PointField::kFloat64 ? 8 : 4; }
  bool overlaps(const Field& other) const {
    return offset < other.offset + other.size() && other.offset < offset + size();
  }
};

/// Where what a scan says of its angles and times cannot be: its other fields say otherwise.
void check_scan(const ros::LaserScan& m, const std::string& name) {
  const double steps = std::max<double>(1.0, static_cast<double>(m.ranges.size())) - 1.0;
  const double increment = m.angle_increment, span = std::abs(increment) * steps;
  const double last = m.angle_min + increment * steps;
  // Drivers count a beam more or less, and round; 0 where they say nothing.
  const double slack = std::fmax(2.0 * std::abs(increment), 0.05 * span) + 1e-3;
  if (m.angle_max != 0.0F && steps > 0.0 && !(std::abs(m.angle_max - last) <= slack)) {
    throw InputError(name + ": " + std::to_string(m.ranges.size()) + " beams from " +
                     number_text(m.angle_min) + " by " + number_text(increment) + " end at " +
                     number_text(last) + " rad, but angle_max is " + number_text(m.angle_max) +
                     "; expected the same");
  }
  const double during = std::abs(static_cast<double>(m.time_increment)) * steps;
  const double most = m.scan_time > 0.0F ? 10.0 * m.scan_time : kLongestScan;
  if (std::isfinite(during) && during > most) {
    throw InputError(name + ": its beams take " + number_text(during) +
                     " s by time_increment, but " +
                     (m.scan_time > 0.0F ? "scan_time is " + number_text(m.scan_time)
                                         : "a scan takes " + number_text(most)) +
                     " s at most; expected seconds between two beams");
  }
}

double coordinate(const std::uint8_t* at, std::uint8_t type) {
  if (type == ros::PointField::kFloat64) {
    double value;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  float value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace

RosLaserScan read_ros_laser_scan(std::string_view cdr, const std::string& name) {
  auto message = ros::from_cdr<ros::LaserScan>(cdr, name);
  RosLaserScan scan;
  scan.angle_min = message.angle_min;
  scan.angle_increment = message.angle_increment;
  scan.time_increment = message.time_increment;
  scan.range_min = message.range_min;
  scan.range_max = message.range_max;
  const std::size_t beams = message.ranges.size();
  if (!std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment) ||
      (beams > 1 && scan.angle_increment == 0.0) ||
      std::abs(scan.angle_increment) * static_cast<double>(beams) > 4.0 * M_PI) {
    throw InputError(name + ": " + std::to_string(beams) + " beams from " +
                     number_text(scan.angle_min) + " by " + number_text(scan.angle_increment) +
                     " rad; expected angles of a scan");
  }
  if (!(scan.range_min >= 0.0 && scan.range_max > scan.range_min)) {
    throw InputError(name + ": range_min " + number_text(scan.range_min) + " and range_max " +
                     number_text(scan.range_max) + " m; expected 0 <= range_min < range_max");
  }
  check_scan(message, name);
  scan.ranges = std::move(message.ranges);
  if (!std::isfinite(scan.time_increment)) scan.time_increment = 0.0;
  return scan;
}

std::vector<Eigen::Vector3d> read_ros_point_cloud(std::string_view cdr, const std::string& name) {
  static_assert(std::endian::native == std::endian::little);
  const auto message = ros::from_cdr<ros::PointCloud2>(cdr, name);
  const std::uint64_t height = message.height, width = message.width;
  std::array<Field, 3> fields;
  std::string names;
  for (const ros::PointField& field : message.point_fields) {
    names += (names.empty() ? "" : ", ") + field.name;
    if (field.name.size() == 1 && field.name[0] >= 'x' && field.name[0] <= 'z') {
      fields[static_cast<std::size_t>(field.name[0] - 'x')] = {field.offset, field.datatype,
                                                               field.count, true};
    }
  }
  const bool big_endian = message.is_bigendian;
  const std::uint64_t point_step = message.point_step, row_step = message.row_step;
  const std::span<const std::uint8_t> data = message.data;
  std::vector<Eigen::Vector3d> points;
  if (height == 0 || width == 0) return points;
  if (big_endian) {
    throw InputError(name + ": points are big-endian (is_bigendian); expected little-endian ones");
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string axis(1, static_cast<char>('x' + i));
    if (!fields[i].there) {
      throw InputError(name + ": fields " + (names.empty() ? "none" : names) +
                       "; expected x, y and z");
    }
    if (fields[i].type != ros::PointField::kFloat32 &&
        fields[i].type != ros::PointField::kFloat64) {
      throw InputError(name + ": field " + axis + " is of type " + std::to_string(fields[i].type) +
                       "; expected FLOAT32 (7) or FLOAT64 (8)");
    }
    if (fields[i].count > 1) {
      throw InputError(name + ": field " + axis + " has a count of " +
                       std::to_string(fields[i].count) + "; expected one number a point");
    }
    if (fields[i].offset + fields[i].size() > point_step) {
      throw InputError(name + ": field " + axis + " at byte " + std::to_string(fields[i].offset) +
                       " of a point of " + std::to_string(point_step) +
                       " bytes; expected it inside");
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Field &one = fields[i], &next = fields[(i + 1) % 3];
    if (!one.overlaps(next)) continue;
    throw InputError(name + ": fields x, y and z share bytes; expected one after another");
  }
  if (point_step * width > data.size() || (height > 1 && row_step < point_step * width) ||
      row_step * (height - 1) + point_step * width > data.size()) {
    throw InputError(name + ": " + std::to_string(width) + " x " + std::to_string(height) +
                     " points of " + std::to_string(point_step) + " bytes, rows of " +
                     std::to_string(row_step) + ", in " + std::to_string(data.size()) +
                     " bytes; expected all of them");
  }
  points.reserve(static_cast<std::size_t>(width * height));
  for (std::uint64_t v = 0; v < height; ++v) {
    for (std::uint64_t u = 0; u < width; ++u) {
      const std::uint8_t* at = data.data() + v * row_step + u * point_step;
      Eigen::Vector3d p;
      for (std::size_t i = 0; i < 3; ++i) {
        p[static_cast<Eigen::Index>(i)] = coordinate(at + fields[i].offset, fields[i].type);
      }
      if (p.allFinite() && p.cwiseAbs().maxCoeff() > kAtTheOrigin) points.push_back(p);
    }
  }
  return points;
}

DepthScan rays_of(const RosLaserScan& scan, const Eigen::Isometry3d& T_end) {
  DepthScan rays;
  const Eigen::AngleAxisd turn(T_end.linear());
  const bool moves = !T_end.isApprox(Eigen::Isometry3d::Identity(), 1e-12);
  const double last = std::max<double>(1.0, static_cast<double>(scan.ranges.size()) - 1.0);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    const bool miss =
        range > 0.0 && (std::isinf(range) || std::abs(range - scan.range_max) < kAtTheEnd);
    if (!miss && !(range >= scan.range_min && range < scan.range_max && range > 0.0)) continue;
    const double a = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    const double far = std::isfinite(scan.range_max) ? scan.range_max : 1000.0;
    Eigen::Vector3d p = (miss ? far : range) * Eigen::Vector3d(std::cos(a), std::sin(a), 0.0);
    if (moves) {
      const double share = static_cast<double>(i) / last;
      p = Eigen::AngleAxisd(share * turn.angle(), turn.axis()) * p + share * T_end.translation();
    }
    (miss ? rays.misses : rays.hits).push_back(p);
  }
  return rays;
}

}  // namespace prospect
