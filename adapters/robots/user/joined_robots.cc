// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/joined_robots.h"

#include <algorithm>
#include <initializer_list>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace prospect {
namespace {

bool is_name(const std::string& text, std::string_view besides) {
  return !text.empty() && text.size() <= 64 && std::ranges::all_of(text, [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           besides.find(c) != std::string_view::npos;
  });
}

[[noreturn]] void refuse_two(const std::string& robot, const char* what) {
  throw std::invalid_argument(robot + ": two of its parts have " + what + "; expected one");
}

/// The one that a part has, into what the robot has.
template <class Part>
void take(Part& all, const Part& part, const std::string& robot, const char* what) {
  if (!part) return;
  if (all) refuse_two(robot, what);
  all = part;
}

}  // namespace

void check(const UserRobot& robot) {
  if (!is_name(robot.name, "_-")) {
    throw std::invalid_argument("the robot's name is '" + robot.name +
                                "'; expected 1 to 64 letters, digits, _ and -");
  }
  if (!robot.make) throw std::invalid_argument(robot.name + ": no make(); expected one");
  std::set<std::string> names;
  for (const OptionInfo& option : robot.options) {
    if (!is_name(option.name, "_")) {
      throw std::invalid_argument(robot.name + ": an option is named '" + option.name +
                                  "'; expected 1 to 64 letters, digits and _");
    }
    if (!names.insert(option.name).second) {
      throw std::invalid_argument(robot.name + ": two options are named '" + option.name +
                                  "'; expected names that differ");
    }
  }
}

void check_streams(const UserRobot& robot) {
  std::string names;
  for (const SensorStream stream : robot.streams) {
    names += (names.empty() ? "" : ", ") + std::string(to_string(stream));
  }
  const auto has_one_of = [&](std::initializer_list<SensorStream> streams) {
    return std::ranges::any_of(robot.streams, [&](SensorStream stream) {
      return std::ranges::find(streams, stream) != streams.end();
    });
  };
  const std::string what = robot.name + ": of its streams (" + names + ") none ";
  using enum SensorStream;
  if (!has_one_of({kDepth, kScan})) {
    throw std::invalid_argument(what +
                                "measures ranges; expected depth or scan, also beside cameras: one "
                                "camera measures no depth, and a pair is not mapped from");
  }
  if (!has_one_of({kPair, kPose, kWheels})) {
    throw std::invalid_argument(what +
                                "says where it is; expected pair, pose or wheels: one camera does "
                                "not localize it");
  }
}

UserRobot joined(const std::vector<UserRobot>& parts) {
  if (parts.empty()) throw std::invalid_argument("a robot of no parts; expected one");
  UserRobot robot = parts.front();
  for (std::size_t k = 1; k < parts.size(); ++k) {
    const UserRobot& part = parts[k];
    robot.name += "-" + part.name;
    for (const SensorStream stream : part.streams) {
      if (std::ranges::find(robot.streams, stream) == robot.streams.end()) {
        robot.streams.push_back(stream);
      }
    }
    robot.settings.insert(robot.settings.end(), part.settings.begin(), part.settings.end());
    robot.options.insert(robot.options.end(), part.options.begin(), part.options.end());
    for (const auto& [number, camera] : part.more_depth) {
      if (!robot.more_depth.emplace(number, camera).second) {
        refuse_two(robot.name, "a depth camera of one number");
      }
    }
    take(robot.depth, part.depth, robot.name, "a depth camera");
    if (robot.start.position.isZero(0.0) && robot.start.yaw == 0.0) robot.start = part.start;
  }
  if (parts.size() > 1) {
    robot.make = [parts, name = robot.name](const Options& options) {
      RobotDrivers all;
      for (const UserRobot& part : parts) {
        const RobotDrivers drivers = part.make(options);
        take(all.base, drivers.base, name, "a base");
        take(all.emergency_stop, drivers.emergency_stop, name, "an emergency stop");
        all.sensors.insert(all.sensors.end(), drivers.sensors.begin(), drivers.sensors.end());
      }
      return all;
    };
  }
  for (const UserRobot& part : parts) check(part);
  check(robot);
  return robot;
}

}  // namespace prospect
