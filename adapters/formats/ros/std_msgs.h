// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

namespace prospect::ros {

// Messages of ROS 2 as plain structs with the standard's names, and each field told to a visitor in
// the standard's order: one description, from which bytes, the text of the definition and the
// type's hash are made (cdr.h, message_definition.h). Sequences of bytes are views (std::span): who
// fills a message keeps the bytes, and what is read lasts as long as what it was read from.

struct Time {
  static constexpr const char* kType = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("sec", m.sec);
    visit("nanosec", m.nanosec);
  }
};

struct Duration {
  static constexpr const char* kType = "builtin_interfaces/msg/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("sec", m.sec);
    visit("nanosec", m.nanosec);
  }
};

/// [s]
inline double seconds(const Time& time) {
  return static_cast<double>(std::int64_t{time.sec} * 1'000'000'000 + time.nanosec) * 1e-9;
}
/// To the nearest nanosecond. What a Time cannot hold, and what is no number, becomes zero, which
/// means "not set".
inline Time time_of(double seconds) {
  if (!(seconds > -2147483648.0 && seconds < 2147483647.0)) return {};
  const auto all = static_cast<std::int64_t>(std::llround(seconds * 1e9));
  std::int64_t whole = all / 1'000'000'000, rest = all % 1'000'000'000;
  if (rest < 0) --whole, rest += 1'000'000'000;
  return {static_cast<std::int32_t>(whole), static_cast<std::uint32_t>(rest)};
}

struct Header {
  static constexpr const char* kType = "std_msgs/msg/Header";
  Time stamp;
  std::string frame_id;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("stamp", m.stamp);
    visit("frame_id", m.frame_id);
  }
};

struct Bool {
  static constexpr const char* kType = "std_msgs/msg/Bool";
  bool data = false;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("data", m.data);
  }
};

struct String {
  static constexpr const char* kType = "std_msgs/msg/String";
  std::string data;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("data", m.data);
  }
};

struct ColorRGBA {
  static constexpr const char* kType = "std_msgs/msg/ColorRGBA";
  float r = 0.0F, g = 0.0F, b = 0.0F, a = 0.0F;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("r", m.r);
    visit("g", m.g);
    visit("b", m.b);
    visit("a", m.a);
  }
};

}  // namespace prospect::ros
