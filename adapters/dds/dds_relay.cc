#include "adapters/dds/dds_relay.h"

#include <cmath>
#include <mutex>
#include <optional>

#include "adapters/dds/dds_node.h"
#include "adapters/files/input_error.h"
#include "adapters/ros/geometry_msgs.h"
#include "perception/odometry/reason.h"
#include "runtime/clock.h"

namespace prospect {

struct DdsRelay::Impl {
  explicit Impl(const DdsOptions& given) : options(given), node(given.address) {
    const DdsOptions::Command& c = options.command;
    if (c.relay.empty()) {
      throw InputError("command.relay: it is none; expected the topic that the relay listens to");
    }
    if (!c.stamped.empty()) stamped = node.advertise<ros::TwistStamped>(c.stamped, kCommandQos);
    if (!c.plain.empty()) plain = node.advertise<ros::Twist>(c.plain, kCommandQos);
    node.subscribe<ros::TwistStamped>(c.relay, kCommandQos,
                                      [this](const ros::TwistStamped& m) { pass(m); });
  }

  void pass(ros::TwistStamped m) {
    const ros::Vector3 &v = m.twist.linear, &w = m.twist.angular;
    if (!std::isfinite(v.x + v.y + v.z) || !std::isfinite(w.x + w.y + w.z)) m.twist = {};
    const std::lock_guard lock(mutex);
    newest = clock.now();
    last = m.header;
    publish(m);
  }
  void publish(const ros::TwistStamped& m) {
    if (stamped >= 0) node.publish(stamped, m);
    if (plain >= 0) node.publish(plain, m.twist);
  }
  /// Zero, if the newest command is older than so many seconds.
  void stop_after(double silence) {
    const std::lock_guard lock(mutex);
    const double now = clock.now();
    if (!newest || now - *newest < silence) return;
    ros::TwistStamped m;
    m.header = last;
    m.header.stamp = ros::time_of(ros::seconds(last.stamp) + (now - *newest));
    publish(m);
  }

  const DdsOptions options;
  const SteadyClock clock;
  int stamped = -1, plain = -1;
  std::mutex mutex;
  std::optional<double> newest;  // [s] arrival
  ros::Header last;
  DdsNode node;  // its thread ends first
};

DdsRelay::DdsRelay(const DdsOptions& options) : impl_(std::make_unique<Impl>(options)) {}
DdsRelay::~DdsRelay() = default;

void DdsRelay::run(const std::function<bool()>& ended,
                   const std::function<void(const std::string&)>& tell) {
  constexpr double kFarewell = 0.2;  // [s]
  const DdsOptions::Command& command = impl_->options.command;
  const SteadyClock& clock = impl_->clock;
  impl_->node.start();
  std::string told;
  while (!ended()) {
    impl_->stop_after(command.dead_man);
    std::string wrong;
    for (const std::string& fault : impl_->node.faults()) add_reason(wrong, fault);
    if (wrong != told) tell(wrong.empty() ? "all topics fit" : wrong);
    told = wrong;
    clock.wait_until(clock.now() + command.relay_period, {});
  }
  const double end = clock.now() + kFarewell;
  while (clock.now() < end) {
    impl_->stop_after(0.0);
    clock.wait_until(clock.now() + command.relay_period, {});
  }
}

}  // namespace prospect
