// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// The topic of DDS that ROS 2 uses for "/left/image_raw": "rt/left/image_raw".
inline std::string dds_topic(const std::string& topic) { return "rt" + topic; }

/// Of the requests of a service "/hold", "rq/holdRequest", and of its answers, "rr/holdReply".
inline std::string dds_requests(const std::string& service) { return "rq" + service + "Request"; }
inline std::string dds_replies(const std::string& service) { return "rr" + service + "Reply"; }

/// "sensor_msgs::msg::dds_::Image_" of "sensor_msgs/msg/Image".
inline std::string dds_type(const std::string& type) {
  const std::size_t first = type.find('/'), last = type.rfind('/');
  return type.substr(0, first) + "::" + type.substr(first + 1, last - first - 1) +
         "::dds_::" + type.substr(last + 1) + '_';
}

/// Its inverse; what is no such name stays as it is.
inline std::string ros_type(const std::string& dds) {
  const std::size_t module = dds.find("::"), type = dds.find("::dds_::");
  if (module == std::string::npos || type == std::string::npos || module >= type ||
      dds.back() != '_') {
    return dds;
  }
  return dds.substr(0, module) + '/' + dds.substr(module + 2, type - module - 2) + '/' +
         dds.substr(type + 8, dds.size() - type - 9);
}

/// Why ROS 2 does not take a name of a topic; empty: it does. "/a/b_1": begins with a slash, each
/// part with a letter or an underscore, at most 247 characters in all.
inline std::string topic_problem(const std::string& topic) {
  const std::string expected = "; expected a name of ROS 2 such as /left/image_raw";
  if (topic.size() < 2 || topic[0] != '/' || topic.back() == '/')
    return "'" + topic + "'" + expected;
  constexpr std::size_t kLongest = 247;
  if (topic.size() > kLongest) {
    return std::to_string(topic.size()) + " characters; expected at most 247";
  }
  for (std::size_t i = 1; i < topic.size(); ++i) {
    const char c = topic[i];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool digit = c >= '0' && c <= '9';
    if (!(letter || (topic[i - 1] != '/' && (digit || c == '/')))) {
      return "'" + topic + "'" + expected;
    }
  }
  return "";
}

}  // namespace prospect
