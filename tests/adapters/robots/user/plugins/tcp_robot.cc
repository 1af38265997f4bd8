// SPDX-License-Identifier: Apache-2.0
// A robot of one's own as a plug-in: a base over TCP (tcp_firmware.cc), whose odometry is its
// localization, and a lidar that is pretended.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

#include "docs/examples/robot/pretended_lidar.h"
#include "models/body_transform.h"
#include "runtime/clock.h"
#include "runtime/plugin_robot.h"
#include "solvers/plugin.h"

namespace {

using namespace prospect;

class TcpRobot final : public Base, public SensorSource {
 public:
  explicit TcpRobot(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      ::close(socket_);
      throw std::invalid_argument("port " + std::to_string(port) +
                                  ": nobody answers; expected the base's firmware there");
    }
    const int on = 1;
    ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    ::fcntl(socket_, F_SETFL, O_NONBLOCK);
  }
  ~TcpRobot() override { ::close(socket_); }

  std::string name() const override { return "tcp"; }
  std::optional<double> dead_man() const override { return 0.3; }  // the firmware's
  void send(const Twist& command, double) override {
    const std::lock_guard lock(mutex_);
    char text[80];
    const int size =
        std::snprintf(text, sizeof text, "V %.6f %.6f\n", command.linear.x(), command.yaw_rate);
    gone_ = gone_ || ::send(socket_, text, static_cast<std::size_t>(size), MSG_NOSIGNAL) != size;
  }
  void stop() override { send({}, 0.0); }
  BaseReport report() override {
    const std::lock_guard lock(mutex_);
    receive();
    BaseReport report;
    report.connected = !gone_ && stamp_ > 0.0;
    report.stamp = stamp_;
    report.velocity = velocity_;
    if (gone_) report.faults.emplace_back("the link to the firmware is gone");
    return report;
  }

  void deliver(FrameSink& frames, const std::stop_token& stop) override {
    do {
      std::optional<Pose> at;
      double stamp = 0.0;
      {
        const std::lock_guard lock(mutex_);
        receive();
        if (stamp_ > 0.0) at = pose_;
        stamp = stamp_;
      }
      if (!at) continue;
      frames.observe(ExternalPose{.stamp = stamp, .T_WB = body_transform(*at)});
      frames.observe(ScanFrame{stamp, std::make_shared<const DepthScan>(turn_of_lidar(*at))});
    } while (clock_.wait_until(clock_.now() + 0.1, stop));
  }

 private:
  void receive() {
    char part[4096];
    ssize_t came = 0;
    while ((came = ::recv(socket_, part, sizeof part, 0)) > 0)
      text_.append(part, static_cast<std::size_t>(came));
    gone_ = gone_ || came == 0;
    for (std::size_t end; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1)) {
      double x, y, yaw, speed, rate;
      const std::string line = text_.substr(0, end);
      if (std::sscanf(line.c_str(), "O %lf %lf %lf %lf %lf", &x, &y, &yaw, &speed, &rate) != 5)
        continue;
      pose_ = {{x, y, 0.0}, yaw};
      velocity_ = {{speed, 0.0, 0.0}, rate};
      stamp_ = clock_.now();
    }
  }

  const SteadyClock clock_;
  const int socket_;
  std::mutex mutex_;  // of what follows
  std::string text_;
  Pose pose_;
  Twist velocity_;
  double stamp_ = 0.0;
  bool gone_ = false;
};

UserRobot describe() {
  UserRobot robot;
  robot.name = "tcp";
  robot.streams = {SensorStream::kPose, SensorStream::kScan};
  robot.settings = {"robot.shape={type: cylinder, radius: 0.18, height: 0.4, center: [0, 0, 0.3]}",
                    "robot.depth={horizontal_fov: 360, vertical_fov: 0, max_range: 3}",
                    "planner.weights.w_l=0", "drive.inbox.poses_in_runtime_clock=true",
                    "drive.inbox.scan_in_runtime_clock=true"};
  robot.options = {{"port", 4321, "of its firmware on this machine"}};
  robot.make = [](const Options& told) {
    const auto tcp = std::make_shared<TcpRobot>(std::get<int>(told.at("port")));
    return RobotDrivers{.base = tcp, .sensors = {tcp}};
  };
  return robot;
}

}  // namespace

const prospect::Plugin* prospect_plugin() {
  static const PluginRobot robot = {kRobotAbi, "a base over TCP", &describe};
  static const Plugin plugin = {
      .interface_version = kPluginInterface, .abi = kPluginAbi, .robot = &robot};
  return &plugin;
}
