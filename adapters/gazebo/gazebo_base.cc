#include "adapters/gazebo/gazebo_base.h"

#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "adapters/gazebo/gazebo_messages.h"
#include "adapters/gazebo/velocity_relay.h"
#include "adapters/gazebo/wheel_encoder.h"

namespace prospect {

struct GazeboBase::Impl {
  Impl(const GazeboOptions& given, const SteadyClock& its_clock)
      : options(given), clock(its_clock), relay(given), node(given.address), encoder(given) {
    poses = "/gazebo/" + gazebo_world_name(options, node) + "/pose/info";
    node.subscribe(poses, "gazebo.msgs.PosesStamped",
                   [this](std::string_view message) { add(message); });
    thread = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  void add(std::string_view message) {
    const std::optional<WheelSample> sample = encoder.add(read_gazebo_poses(message));
    if (!sample) return;
    const std::lock_guard lock(mutex);
    heard = clock.now();
    if (wheels.size() == kMost) wheels.erase(wheels.begin());
    wheels.push_back(*sample);
    velocity = {{sample->velocity.x(), 0.0, 0.0}, sample->yaw_rate};
  }

  void run(const std::stop_token& stop) noexcept {
    try {
      while (!stop.stop_requested()) {
        node.spin(kPeriod);
        const std::lock_guard lock(mutex);
        stands = node.connected() && node.publishers(poses) > 0;
        faults = node.faults();
      }
    } catch (...) {
      // Memory is used up.
      const std::lock_guard lock(mutex);
      stands = false;
    }
  }

  static constexpr double kPeriod = 0.02;  // [s]
  static constexpr double kSilence = 0.5;  // [s] of the wheels that is a fault
  static constexpr std::size_t kMost = 10000;
  GazeboOptions options;
  const SteadyClock& clock;
  VelocityRelay relay;  // before the thread
  GazeboNode node;      // of the thread, as the encoder
  WheelEncoder encoder;
  std::string poses;
  std::mutex mutex;
  bool stands = false;
  std::optional<double> heard;
  Twist velocity;
  std::vector<WheelSample> wheels;
  std::vector<std::string> faults;
  std::jthread thread;  // ends first
};

GazeboBase::GazeboBase(const GazeboOptions& options, const SteadyClock& clock) {
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
  impl_->relay.send(command, expires);
}

void GazeboBase::stop() noexcept { impl_->relay.send({}, 0.0); }

BaseReport GazeboBase::report() noexcept {
  BaseReport report;
  try {
    const VelocityRelay::Report relay = impl_->relay.state();
    const std::lock_guard lock(impl_->mutex);
    report.connected = relay.connected && impl_->stands && impl_->heard.has_value();
    report.stamp = impl_->heard.value_or(0.0);
    report.velocity = impl_->velocity;
    report.wheels = std::exchange(impl_->wheels, {});
    report.faults = impl_->faults;
    if (!relay.fault.empty()) report.faults.push_back("relay: " + relay.fault);
    if (impl_->heard && impl_->clock.now() - *impl_->heard > Impl::kSilence) {
      report.faults.emplace_back("the wheels are silent");
    }
  } catch (...) {
    // Memory is used up: no word is a link that is down.
    report.connected = false;
  }
  return report;
}

int GazeboBase::relay_process() const { return impl_->relay.process(); }

}  // namespace prospect
