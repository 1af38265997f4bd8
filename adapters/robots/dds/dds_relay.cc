// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_relay.h"

#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/robots/dds/command_gate.h"
#include "adapters/robots/dds/dds_node.h"
#include "models/reason.h"
#include "runtime/clock.h"

namespace prospect {

namespace {

CommandGate::Limits gate_limits(const DdsOptions::Command& command) {
  std::vector<std::string> missing;
  const auto given = [&](const std::optional<double>& limit, const char* key) {
    if (!limit) {
      missing.push_back(std::string("command.") + key +
                        ": nobody says it; expected what the relay bounds commands to");
    }
    return limit.value_or(0.0);
  };
  const BaseLimits& most = command.limits;
  const CommandGate::Limits limits{given(most.speed, "speed"),
                                   given(most.yaw_rate, "yaw_rate"),
                                   given(most.acceleration, "acceleration"),
                                   given(most.yaw_acceleration, "yaw_acceleration"),
                                   command.dead_man,
                                   command.relay_period};
  if (!missing.empty()) throw InputError(missing);
  return limits;
}

double time_of_day() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

struct DdsRelay::Impl {
  explicit Impl(const DdsOptions& given)
      : options(given), gate(gate_limits(given.command)), node(given.address) {
    const DdsOptions::Command& c = options.command;
    if (!c.stamped.empty()) stamped = node.advertise<ros::TwistStamped>(c.stamped, kCommandQos);
    if (!c.plain.empty()) plain = node.advertise<ros::Twist>(c.plain, kCommandQos);
    for (const std::string& topic : {c.stamped, c.plain}) {
      if (!topic.empty()) outputs.push_back(topic);
    }
    node.subscribe<ros::TwistStamped>(c.relay, kCommandQos,
                                      [this](const ros::TwistStamped& m) { pass(m); });
  }

  void pass(const ros::TwistStamped& m) {
    const double stamp = ros::seconds(m.header.stamp);
    const bool judged = options.command.relay_age == DdsOptions::RelayAge::kStamp && stamp != 0.0;
    const double age = judged ? time_of_day() - stamp : 0.0;
    {
      const std::lock_guard lock(mutex);
      const double now = clock.now();
      gate.take(m.twist, age, now);
      if (!arrived || std::abs(age) < options.command.dead_man) {
        arrived = now;
        last = m.header;
      }
    }
    send();
  }
  /// Who commands, through this relay or past it.
  std::vector<std::string> commanders() const {
    std::vector<std::string> names = node.publisher_names(options.command.relay);
    for (const std::string& topic : outputs) {
      // This relay is the first of them.
      const std::vector<std::string> all = node.publisher_names(topic);
      for (std::size_t n = 1; n < all.size(); ++n) names.push_back(all[n] + " on " + topic);
    }
    return names;
  }
  /// What the gate lets out now.
  void send() {
    const std::lock_guard lock(mutex);
    const double now = clock.now();
    const std::optional<ros::Twist> twist = gate.output(commanders(), now);
    if (!twist) return;
    ros::TwistStamped m;
    m.header = last;
    m.header.stamp = ros::time_of(ros::seconds(last.stamp) + (now - arrived.value_or(now)));
    m.twist = *twist;
    if (stamped >= 0) node.publish(stamped, m);
    if (plain >= 0) node.publish(plain, m.twist);
  }
  /// Of commands and topics.
  std::string wrong() {
    std::string text;
    for (const std::string& fault : node.faults()) add_reason(text, fault);
    const std::lock_guard lock(mutex);
    if (const std::string line = gate.complaint(clock.now()); !line.empty()) {
      add_reason(text, options.command.relay + ": " + line);
    }
    return text;
  }
  void close() {
    const std::lock_guard lock(mutex);
    gate.close();
  }

  const DdsOptions options;
  const SteadyClock clock;
  int stamped = -1, plain = -1;
  std::vector<std::string> outputs;  // topics
  std::mutex mutex;
  CommandGate gate;
  std::optional<double> arrived;  // [s] of the newest command
  ros::Header last;               // its
  DdsNode node;                   // its thread ends first
};

DdsRelay::DdsRelay(const DdsOptions& options) {
  if (options.command.relay.empty()) {
    throw InputError("command.relay: it is none; expected the topic that the relay listens to");
  }
  impl_ = std::make_unique<Impl>(options);
}
DdsRelay::~DdsRelay() = default;

void DdsRelay::run(const std::function<bool()>& ended,
                   const std::function<void(const std::string&)>& tell) {
  constexpr double kFarewell = 0.2;  // [s]
  const DdsOptions::Command& command = impl_->options.command;
  const SteadyClock& clock = impl_->clock;
  impl_->node.start();
  std::string told;
  while (!ended()) {
    impl_->send();
    const std::string wrong = impl_->wrong();
    if (wrong != told) tell(wrong.empty() ? "nothing is wrong any more" : wrong);
    told = wrong;
    clock.wait_until(clock.now() + command.relay_period, {});
  }
  impl_->close();
  const double end = clock.now() + kFarewell;
  while (clock.now() < end) {
    impl_->send();
    clock.wait_until(clock.now() + command.relay_period, {});
  }
}

}  // namespace prospect
