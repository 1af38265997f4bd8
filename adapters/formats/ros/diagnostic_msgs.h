// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

struct KeyValue {
  static constexpr const char* kType = "diagnostic_msgs/msg/KeyValue";
  std::string key;
  std::string value;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("key", m.key);
    visit("value", m.value);
  }
};

struct DiagnosticStatus {
  static constexpr const char* kType = "diagnostic_msgs/msg/DiagnosticStatus";
  static constexpr std::byte kOk{0}, kWarn{1}, kError{2}, kStale{3};
  std::byte level = kOk;
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("level", m.level);
    visit("name", m.name);
    visit("message", m.message);
    visit("hardware_id", m.hardware_id);
    visit("values", m.values);
  }
};

struct DiagnosticArray {
  static constexpr const char* kType = "diagnostic_msgs/msg/DiagnosticArray";
  Header header;
  std::vector<DiagnosticStatus> status;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("status", m.status);
  }
};

}  // namespace prospect::ros
