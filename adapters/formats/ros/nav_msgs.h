// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

/// The pose in the header's frame, the velocity in the child's.
struct Odometry {
  static constexpr const char* kType = "nav_msgs/msg/Odometry";
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("child_frame_id", m.child_frame_id);
    visit("pose", m.pose);
    visit("twist", m.twist);
  }
};

struct Path {
  static constexpr const char* kType = "nav_msgs/msg/Path";
  Header header;
  std::vector<PoseStamped> poses;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("poses", m.poses);
  }
};

struct MapMetaData {
  static constexpr const char* kType = "nav_msgs/msg/MapMetaData";
  Time map_load_time;
  float resolution = 0.0F;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose origin;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("map_load_time", m.map_load_time);
    visit("resolution", m.resolution);
    visit("width", m.width);
    visit("height", m.height);
    visit("origin", m.origin);
  }
};

/// Cells by rows from the origin's corner: 0 free to 100 occupied, -1 unknown.
struct OccupancyGrid {
  static constexpr const char* kType = "nav_msgs/msg/OccupancyGrid";
  Header header;
  MapMetaData info;
  std::span<const std::int8_t> data;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("info", m.info);
    visit("data", m.data);
  }
};

}  // namespace prospect::ros
