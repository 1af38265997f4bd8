// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/velocity_relay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string_view>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"
#include "adapters/robots/gazebo/gazebo_messages.h"
#include "runtime/clock.h"
#include "runtime/relay_process.h"
#include "runtime/simulation_clock.h"

namespace prospect {
namespace {

constexpr double kFarewell = 0.2;  // [s] of zero velocity when its owner has gone
constexpr double kWord = 0.1;      // [s] between two reports
constexpr double kSilence = 1.0;   // [s] of the simulation without one that is a fault

// What goes over the link.
struct Command {
  double speed = 0.0, yaw_rate = 0.0, expires = 0.0;
};
struct Word {
  bool ready = false;   // false: it could not begin, for the reason
  bool absent = false;  // as the transport is not built in
  bool connected = false;
  std::array<char, 240> fault{};

  void say(const std::string& text) {
    std::snprintf(fault.data(), fault.size(), "%s", text.c_str());
  }
};

/// The relay's own loop.
class Relay {
 public:
  Relay(const GazeboOptions& options, int link)
      : options_(options), link_(link), node_(options.address) {
    topic_ = "/gazebo/" + gazebo_world_name(options, node_) + "/" + options.model + "/vel_cmd";
    node_.advertise(topic_, "gazebo.msgs.Pose");
    node_.subscribe(
        "/gazebo/" + gazebo_world_name(options, node_) + "/pose/info", "gazebo.msgs.PosesStamped",
        [this](std::string_view message) { clock_.tick(read_gazebo_poses(message).stamp); });
  }

  void run() {
    double told = -1e9, zero = -1e9;
    bool owned = true;
    double end = 0.0;
    while (owned || machine_.now() < end) {
      const bool held = clock_.now() < std::min(newest_ + options_.dead_man, expires_);
      const double until =
          held ? std::min(newest_ + options_.dead_man, expires_) - clock_.now() : options_.period;
      // The link that has closed can be read for ever: its owner is gone.
      node_.spin(std::min(std::max(until, 0.0), options_.period), owned ? link_ : -1);
      if (owned && !take()) {
        owned = false;
        expires_ = 0.0;
        end = machine_.now() + kFarewell;
      }
      const double now = machine_.now();
      if (clock_.now() >= std::min(newest_ + options_.dead_man, expires_) &&
          now - zero >= options_.period) {
        zero = now;
        node_.publish(topic_, gazebo_velocity({}, options_.turned_yaw));
      }
      if (owned && now - told >= kWord) {
        told = now;
        tell();
      }
    }
  }

 private:
  /// The commands that have come; false: the owner is gone.
  bool take() {
    for (;;) {
      Command command;
      const LinkRead read = receive_on(link_, command);
      if (read != LinkRead::kMessage) return read == LinkRead::kNothing;
      newest_ = clock_.now();
      expires_ = command.expires;
      if (newest_ >= expires_) continue;
      const Twist twist{{command.speed, 0.0, 0.0}, command.yaw_rate};
      node_.publish(topic_, gazebo_velocity(twist, options_.turned_yaw));
    }
  }

  void tell() {
    Word word;
    word.ready = true;
    word.connected = node_.connected() && node_.subscribers(topic_) > 0;
    if (!node_.faults().empty()) word.say(node_.faults().back());
    send_on(link_, word);
  }

  const GazeboOptions& options_;
  int link_;
  GazeboNode node_;
  SteadyClock machine_;
  SimulationClock clock_{machine_};
  std::string topic_;
  double newest_ = -1e9, expires_ = -1e9;
};

void relay(const GazeboOptions& options, int link) noexcept {
  Word word;
  try {
    Relay(options, link).run();
    return;
  } catch (const NotBuiltIn& error) {
    word.absent = true;
    word.say(error.what());
  } catch (const std::exception& error) {
    word.say(error.what());
  } catch (...) {
    word.say("the relay failed");
  }
  send_on(link, word);
}

}  // namespace

VelocityRelay::VelocityRelay(const GazeboOptions& options) {
  check(options);
  process_.emplace("gazebo", std::vector<int>(), [&](int link) { relay(options, link); });
  Word word;
  process_->wait(2.0 * options.address.timeout + 1.0);
  if (receive_on(process_->link(), word) != LinkRead::kMessage) {
    word.say("gazebo: the relay does not answer; expected it to run");
  }
  if (!word.ready) {
    process_->kill();
    if (word.absent) {
      throw NotBuiltIn("the transport of Gazebo", "libprotobuf-dev and protobuf-compiler");
    }
    throw InputError(std::string(word.fault.data()));
  }
  report_ = {word.connected, word.fault.data()};
}

bool VelocityRelay::send(const Twist& velocity, double expires) noexcept {
  Command command{velocity.linear.x(), velocity.yaw_rate, expires};
  if (!std::isfinite(command.speed) || !std::isfinite(command.yaw_rate) ||
      !std::isfinite(expires)) {
    command = {};
  }
  return send_on(process_->link(), command);
}

VelocityRelay::Report VelocityRelay::state(double now) noexcept {
  silent_ += std::clamp(now - asked_, 0.0, kWord);
  asked_ = now;
  Word word;
  LinkRead read;
  while ((read = receive_on(process_->link(), word)) == LinkRead::kMessage) {
    silent_ = 0.0;
    report_ = {word.connected, word.fault.data()};
  }
  if (read == LinkRead::kEnded) report_ = {false, "the relay has ended: nothing stops the robot"};
  if (silent_ > kSilence && report_.fault.empty()) {
    report_ = {false, "the relay is silent"};
  }
  return report_;
}

}  // namespace prospect
