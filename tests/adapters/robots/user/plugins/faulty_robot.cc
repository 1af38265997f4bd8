// SPDX-License-Identifier: Apache-2.0
// A robot as a plug-in, with one fault, which the environment variable PROSPECT_TEST_FAULT names at
// the moment when it is asked for.
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "models/body_transform.h"
#include "runtime/clock.h"
#include "runtime/plugin_robot.h"
#include "solvers/plugin.h"

namespace {

using namespace prospect;

std::string fault() {
  const char* text = std::getenv("PROSPECT_TEST_FAULT");
  return text ? text : "";
}

class OddBase final : public Base {
 public:
  std::string name() const override { return "odd\nbase"; }
  std::optional<double> dead_man() const override {
    if (fault() == "dead_man throws") throw std::runtime_error("no dead-man today");
    return 0.4;
  }
  void send(const Twist&, double) override {
    if (fault() == "send throws") throw std::runtime_error("no motors\ntoday");
  }
  void stop() override {}
  BaseReport report() override {
    if (fault() == "report throws a number") throw 42;
    BaseReport report;
    report.connected = true;
    report.stamp = SteadyClock().now();
    if (fault() == "fault without words") report.faults = {""};
    return report;
  }
};

class OddSensors final : public SensorSource {
 public:
  void deliver(FrameSink& frames, const std::stop_token& stop) override {
    if (fault() == "sensors throw a number") throw 42;
    const SteadyClock clock;
    do {
      const double now = clock.now();
      if (fault() == "frames of nothing") {
        frames.observe(ScanFrame{now, nullptr});
        frames.observe(DepthFrame{now, nullptr});
        frames.observe(StereoFrame{now, now, nullptr, nullptr});
        frames.observe(EstimateFrame{now, nullptr});
        frames.observe(ScanFrame{std::nan(""), std::make_shared<const DepthScan>()});
        frames.observe(WheelSample{std::nan(""), {std::nan(""), HUGE_VAL}, std::nan("")});
      }
      frames.observe(ExternalPose{.stamp = now});
    } while (clock.wait_until(clock.now() + 0.02, stop));
  }
};

RobotDrivers make(const Options& options) {
  if (fault() == "make throws")
    throw std::invalid_argument("no robot at " + std::get<std::string>(options.at("port")));
  return {.base = std::make_shared<OddBase>(), .sensors = {std::make_shared<OddSensors>()}};
}

UserRobot describe() {
  const std::string f = fault();
  if (f == "describe throws") throw std::runtime_error("no licence");
  if (f == "describe throws a number") throw 42;
  UserRobot robot;
  robot.name = f == "name" ? "my robot" : "odd";
  robot.streams = {SensorStream::kPose};
  robot.settings = {"drive.inbox.poses_in_runtime_clock=true"};
  robot.options = {{"port", std::string("nowhere"), "where it is"},
                   {"rate", 5, "of something [1/s]"}};
  if (f == "option") robot.options[0].name = "a port";
  if (f == "option twice") robot.options[0].name = "rate";
  if (f != "no make") robot.make = make;
  return robot;
}

}  // namespace

const prospect::Plugin* prospect_plugin() {
  // Not const: each call gives another one. The tests load from one thread.
  static PluginRobot robot;
  static Plugin plugin;
  robot = {kRobotAbi, "one with a fault", &describe};
  plugin = {.interface_version = kPluginInterface, .abi = kPluginAbi, .robot = &robot};
  const std::string f = fault();
  if (f == "report") ++robot.abi.report;
  if (f == "frame") ++robot.abi.frame;
  if (f == "no describe") robot.describe = nullptr;
  if (f == "no robot") plugin.robot = nullptr;
  return &plugin;
}
