// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_receiver.h"

#include <algorithm>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

namespace prospect {

struct GazeboReceiver::Impl {
  explicit Impl(const GazeboOptions& options)
      : node(options.address), world(gazebo_world_name(options, node)) {}

  void run(const std::stop_token& stop) noexcept {
    try {
      while (!stop.stop_requested()) {
        node.spin(kPeriod);
        const bool all = node.connected() &&
                         std::all_of(topics.begin(), topics.end(), [&](const std::string& topic) {
                           return node.publishers(topic) > 0;
                         });
        const std::lock_guard lock(mutex);
        connected = all;
        faults = node.faults();
      }
    } catch (...) {
      // Memory is used up: what was known is known, and nothing is connected.
      const std::lock_guard lock(mutex);
      connected = false;
    }
  }

  static constexpr double kPeriod = 0.02;  // [s]
  GazeboNode node;                         // of the thread, once it runs
  std::string world;
  std::vector<std::string> topics;
  mutable std::mutex mutex;
  bool connected = false;
  std::vector<std::string> faults;
  std::jthread thread;  // ends first
};

GazeboReceiver::GazeboReceiver(const GazeboOptions& options) {
  check(options);
  impl_ = std::make_unique<Impl>(options);
}
GazeboReceiver::~GazeboReceiver() = default;

void GazeboReceiver::subscribe(const std::string& topic, const std::string& type,
                               GazeboNode::Handler handler) {
  impl_->topics.push_back("/gazebo/" + impl_->world + "/" + topic);
  impl_->node.subscribe(impl_->topics.back(), type, std::move(handler));
}

void GazeboReceiver::start() {
  impl_->thread = std::jthread([this](const std::stop_token& stop) { impl_->run(stop); });
}

const std::string& GazeboReceiver::world() const { return impl_->world; }

bool GazeboReceiver::connected() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->connected;
}

std::vector<std::string> GazeboReceiver::faults() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->faults;
}

}  // namespace prospect
