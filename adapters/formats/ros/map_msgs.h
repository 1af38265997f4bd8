// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

/// A rectangle of an OccupancyGrid that has changed: cells by rows, from (x, y) of the grid.
struct OccupancyGridUpdate {
  static constexpr const char* kType = "map_msgs/msg/OccupancyGridUpdate";
  Header header;
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::span<const std::int8_t> data;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("x", m.x);
    visit("y", m.y);
    visit("width", m.width);
    visit("height", m.height);
    visit("data", m.data);
  }
};

}  // namespace prospect::ros
