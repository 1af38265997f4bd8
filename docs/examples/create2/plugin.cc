// SPDX-License-Identifier: Apache-2.0
// A Create 2 as a plug-in: prospect drive --base plugin:libcreate2.so --base plugin:SENSORS.so
//   --set base.device=/dev/ttyUSB0
#include "solvers/plugin.h"

#include <memory>
#include <string>
#include <variant>

#include "create2_base.h"
#include "runtime/plugin_robot.h"

namespace {

using namespace prospect;

RobotDrivers make(const Options& told) {
  Create2Options options;
  options.device = std::get<std::string>(told.at("device"));
  options.rate = std::get<int>(told.at("rate"));
  options.dead_man = std::get<double>(told.at("dead_man"));
  return {.base = std::make_shared<Create2Base>(options), .sensors = {}};
}

UserRobot describe() {
  const Create2Options defaults;
  UserRobot robot;
  robot.name = "create2";
  robot.settings = {"robot.shape={type: cylinder, radius: 0.18, height: 0.4, center: [0, 0, 0.3]}",
                    "robot.motion.v_max=0.3"};
  robot.options = {
      {"device", defaults.device, "serial line"},
      {"rate", defaults.rate, "of the line [baud]: 19200, 57600 or 115200"},
      {"dead_man", defaults.dead_man, "after which it stops by itself [s], 0.05 to 2"}};
  robot.make = make;
  return robot;
}

}  // namespace

const prospect::Plugin* prospect_plugin() {
  static const PluginRobot robot = {kRobotAbi, "an iRobot Create 2 on a serial line", &describe};
  static const Plugin plugin = {
      .interface_version = kPluginInterface, .abi = kPluginAbi, .robot = &robot};
  return &plugin;
}
