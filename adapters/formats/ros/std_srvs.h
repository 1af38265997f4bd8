// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace prospect::ros {

/// std_srvs/srv/Trigger. What is empty holds a byte in ROS 2.
struct TriggerRequest {
  static constexpr const char* kType = "std_srvs/srv/Trigger_Request";
  std::uint8_t empty = 0;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("structure_needs_at_least_one_member", m.empty);
  }
};

struct TriggerResponse {
  static constexpr const char* kType = "std_srvs/srv/Trigger_Response";
  bool success = false;
  std::string message;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("success", m.success);
    visit("message", m.message);
  }
};

}  // namespace prospect::ros
