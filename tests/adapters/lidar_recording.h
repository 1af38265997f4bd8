// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "tests/adapters/ros_bag_writer.h"

namespace prospect::test {

/// A robot with a 2-D lidar turns and drives in a room of 4 x 3 m with a box in it, all walls along
/// the axes. The lidar is 0.18 m high, 0.1 m ahead of base_link and mounted backwards.
struct LidarRecording {
  static constexpr std::int64_t kStart = 1'700'000'000'000'000'000;  // [ns]
  static constexpr std::int64_t kStep = 100'000'000;
  int scans = 20;
  int beams = 180;
  Eigen::Vector2d low{-1.51, -1.01}, high{2.46, 1.96};  // of the room [m]
  Eigen::Vector2d box_low{1.01, 0.51}, box_high{1.49, 0.99};
  Eigen::Isometry3d T_BS = at(0.1, 0.0, 0.18, M_PI);

  static Eigen::Isometry3d at(double x, double y, double z, double yaw) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << x, y, z;
    T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return T;
  }
  /// base_link in odom, `k` steps after the start.
  Eigen::Isometry3d body(double k) const { return at(-0.6 + 0.05 * k, 0.01 * k, 0.0, 0.12 * k); }

  double range(const Eigen::Vector3d& from, double angle) const {
    const Eigen::Vector2d o = from.head<2>(), d(std::cos(angle), std::sin(angle));
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2; ++i) {
      if (std::abs(d[i]) < 1e-12) continue;
      for (const double wall : {low[i], high[i]}) {
        const double s = (wall - o[i]) / d[i];
        if (s > 0.0) best = std::min(best, s);
      }
      for (const double side : {box_low[i], box_high[i]}) {
        const double s = (side - o[i]) / d[i];
        const double other = o[1 - i] + s * d[1 - i];
        if (s > 0.0 && other >= box_low[1 - i] && other <= box_high[1 - i])
          best = std::min(best, s);
      }
    }
    return best;
  }
  /// Ranges of scan k, its last beam `during` steps after its first.
  std::vector<float> ranges(int k, double during = 0.0, double span = 2.0 * M_PI) const {
    std::vector<float> out;
    for (int i = 0; i < beams; ++i) {
      const Eigen::Isometry3d T = body(k + during * i / (beams - 1)) * T_BS;
      const double yaw = std::atan2(T.linear()(1, 0), T.linear()(0, 0));
      out.push_back(
          static_cast<float>(range(T.translation(), yaw - 0.5 * span + span * i / beams)));
    }
    return out;
  }

  static std::string transform_message(std::int64_t t, const std::string& parent,
                                       const std::string& child, const Eigen::Isometry3d& T) {
    return CdrWriter().number(std::uint32_t{1}).header(t, parent).text(child).pose(T).str();
  }
  static std::string scan_message(std::int64_t t, const std::vector<float>& ranges,
                                  float time_increment = 0.0F, float range_max = 12.0F) {
    CdrWriter w;
    const float step = static_cast<float>(2.0 * M_PI / static_cast<double>(ranges.size()));
    w.header(t, "laser").number(static_cast<float>(-M_PI)).number(static_cast<float>(M_PI) - step);
    w.number(step).number(time_increment).number(0.1F).number(0.1F).number(range_max);
    w.number(static_cast<std::uint32_t>(ranges.size()));
    for (const float r : ranges) w.number(r);
    return w.number(std::uint32_t{0}).str();
  }

  /// As a bag: /scan, /tf of odom to base_link half a step off the scans, /tf_static of the lidar.
  /// The last beam is `during` steps after the first. With clouds: /points instead of /scan.
  std::vector<BagMessage> messages(double during = 0.0, bool clouds = false) const {
    std::vector<BagMessage> out;
    const char* const tf = "tf2_msgs/msg/TFMessage";
    out.push_back(
        {"/tf_static", tf, kStart, transform_message(kStart, "base_link", "laser", T_BS)});
    for (int k = 0; k <= scans; ++k) {
      const std::int64_t t = kStart + kStep * k, half = t - kStep / 2;
      out.push_back({"/tf", tf, half, transform_message(half, "odom", "base_link", body(k - 0.5))});
      if (k == scans) break;
      if (clouds) {
        out.push_back({"/points", "sensor_msgs/msg/PointCloud2", t, cloud_message(t, k)});
        continue;
      }
      const auto increment = static_cast<float>(0.1 * during / (beams - 1));
      out.push_back(
          {"/scan", "sensor_msgs/msg/LaserScan", t, scan_message(t, ranges(k, during), increment)});
    }
    return out;
  }

  /// The walls of scan k as the points of many planes of rays, float32 x, y and z in the lidar's
  /// frame.
  std::string cloud_message(std::int64_t t, int k) const {
    std::string data;
    const std::vector<float> seen = ranges(k);
    for (int i = 0; i < beams; ++i) {
      const double angle = -M_PI + 2.0 * M_PI * i / beams;
      const float r = seen[static_cast<std::size_t>(i)];
      for (const double height : {0.0, 0.125, 0.325, 0.475}) {
        for (const double v :
             {r * std::cos(angle), r * std::sin(angle), height - T_BS.translation().z()}) {
          const auto number = static_cast<float>(v);
          data.append(reinterpret_cast<const char*>(&number), sizeof number);
        }
      }
    }
    const auto points = static_cast<std::uint32_t>(4 * beams);
    CdrWriter w;
    w.header(t, "laser").number(std::uint32_t{1}).number(points).number(std::uint32_t{3});
    for (std::uint32_t i = 0; i < 3; ++i) {
      w.text(std::string(1, "xyz"[i])).number(4 * i).number(std::uint8_t{7});
      w.number(std::uint32_t{1});
    }
    w.number(std::uint8_t{0}).number(std::uint32_t{12}).number(12 * points);
    return w.bytes(data).number(std::uint8_t{1}).str();
  }

  /// As a log of CARMEN: FLASER lines over the half turn ahead of the lidar.
  std::string carmen_log() const {
    std::ostringstream text;
    text.precision(9);
    text << "# CARMEN Logfile\nPARAM robot_frontlaser_offset 0.1 0 host 0\n";
    for (int k = 0; k < scans; ++k) {
      const Eigen::Isometry3d T = body(k) * T_BS;
      const double yaw = std::atan2(T.linear()(1, 0), T.linear()(0, 0));
      text << "ODOM 0 0 0 0 0 0 " << 0.1 * k << " host " << 0.1 * k << "\nFLASER " << beams;
      for (const float r : ranges(k, 0.0, M_PI)) text << ' ' << r;
      text << ' ' << T.translation().x() << ' ' << T.translation().y() << ' ' << yaw << " 0 0 0 "
           << 10.0 + 0.1 * k << " host " << 0.1 * k << "\n";
    }
    return text.str();
  }
};

}  // namespace prospect::test
