// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/formats/ros/geometry_msgs.h"

namespace prospect::ros {

struct TFMessage {
  static constexpr const char* kType = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("transforms", m.transforms);
  }
};

}  // namespace prospect::ros
