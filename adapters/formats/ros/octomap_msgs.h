// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

/// An octree's bytes as OctoMap writes them behind the head of its file: of a .bt file if `binary`,
/// else of an .ot file.
struct Octomap {
  static constexpr const char* kType = "octomap_msgs/msg/Octomap";
  Header header;
  bool binary = false;
  std::string id;
  double resolution = 0.0;
  std::span<const std::int8_t> data;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("binary", m.binary);
    visit("id", m.id);
    visit("resolution", m.resolution);
    visit("data", m.data);
  }
};

}  // namespace prospect::ros
