// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_base.h"

#include <deque>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "adapters/robots/gazebo/gazebo_messages.h"
#include "adapters/robots/gazebo/gazebo_receiver.h"
#include "adapters/robots/gazebo/velocity_relay.h"
#include "adapters/robots/gazebo/wheel_encoder.h"

namespace prospect {

struct GazeboBase::Impl {
  Impl(const GazeboOptions& given, SimulationClock& its_clock)
      : options(given), clock(its_clock), relay(given), encoder(given), receiver(given) {
    receiver.subscribe("pose/info", "gazebo.msgs.PosesStamped",
                       [this](std::string_view message) { add(message); });
    receiver.start();
  }

  void add(std::string_view message) {
    const GazeboPoses poses = read_gazebo_poses(message);
    clock.tick(poses.stamp);
    const std::optional<WheelSample> sample = encoder.add(poses);
    if (!sample) return;
    const std::lock_guard lock(mutex);
    heard = clock.now();
    if (wheels.size() == kMost) wheels.pop_front();
    wheels.push_back(*sample);
    velocity = {{sample->velocity.x(), 0.0, 0.0}, sample->yaw_rate};
  }

  static constexpr std::size_t kMost = 10000;
  GazeboOptions options;
  SimulationClock& clock;
  VelocityRelay relay;   // before threads
  WheelEncoder encoder;  // of the receiver's thread
  std::mutex mutex;
  std::optional<double> heard;  // in the simulation's time
  Twist velocity;
  std::deque<WheelSample> wheels;
  GazeboReceiver receiver;  // its thread ends first
};

GazeboBase::GazeboBase(const GazeboOptions& options, SimulationClock& clock) {
  check(options);
  impl_ = std::make_unique<Impl>(options, clock);
}
GazeboBase::~GazeboBase() = default;

std::string GazeboBase::name() const noexcept { return "gazebo"; }

std::optional<double> GazeboBase::dead_man() const noexcept {
  // The relay sees it at the end of a period at the latest.
  return impl_->options.dead_man + impl_->options.period;
}

void GazeboBase::send(const Twist& command, double expires) noexcept {
  if (expires > impl_->clock.now()) {
    impl_->relay.send(command, expires);
  } else {
    stop();
  }
}

void GazeboBase::stop() noexcept { impl_->relay.send({}, 0.0); }

BaseReport GazeboBase::report() noexcept {
  BaseReport report;
  try {
    const VelocityRelay::Report relay = impl_->relay.state(impl_->clock.now());
    const bool connected = impl_->receiver.connected();
    report.faults = impl_->receiver.faults();
    const std::lock_guard lock(impl_->mutex);
    report.connected = relay.connected && connected && impl_->heard.has_value();
    report.stamp = impl_->heard.value_or(0.0);
    report.velocity = impl_->velocity;
    report.wheels.assign(impl_->wheels.begin(), impl_->wheels.end());
    impl_->wheels.clear();
    if (!relay.fault.empty()) report.faults.push_back("relay: " + relay.fault);
  } catch (...) {
    // Memory is used up: no word is a link that is down.
    report.connected = false;
  }
  return report;
}

const std::string& GazeboBase::world() const { return impl_->receiver.world(); }

int GazeboBase::relay_process() const { return impl_->relay.process(); }

}  // namespace prospect
