// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

struct Log {
  static constexpr const char* kType = "rcl_interfaces/msg/Log";
  static constexpr std::uint8_t kDebug = 10, kInfo = 20, kWarn = 30, kError = 40, kFatal = 50;
  Time stamp;
  std::uint8_t level = 0;
  std::string name;
  std::string msg;
  std::string file;
  std::string function;
  std::uint32_t line = 0;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("stamp", m.stamp);
    visit("level", m.level);
    visit("name", m.name);
    visit("msg", m.msg);
    visit("file", m.file);
    visit("function", m.function);
    visit("line", m.line);
  }
};

}  // namespace prospect::ros
