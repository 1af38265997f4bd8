// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

struct Clock {
  static constexpr const char* kType = "rosgraph_msgs/msg/Clock";
  Time clock;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("clock", m.clock);
  }
};

}  // namespace prospect::ros
