#include "adapters/gazebo/gazebo_sensors.h"

#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "adapters/gazebo/gazebo_messages.h"

namespace prospect {

struct GazeboSensors::Impl {
  Impl(const GazeboOptions& options, SensorInbox& inbox) : node(options.address) {
    const std::string prefix = "/gazebo/" + gazebo_world_name(options, node) + "/" + options.model +
                               "/" + options.link + "/";
    stereo = prefix + options.stereo + "/images";
    node.subscribe(stereo, "gazebo.msgs.ImagesStamped", [&inbox](std::string_view message) {
      GazeboPair pair = read_gazebo_pair(message);
      inbox.pair(pair.stamp, pair.stamp, std::move(pair.images));
    });
    if (!options.depth.empty()) {
      depth = prefix + options.depth + "/image";
      node.subscribe(depth, "gazebo.msgs.ImageStamped",
                     [&inbox, range = options.depth_range](std::string_view message) {
                       GazeboDepth image = read_gazebo_depth(message, range);
                       inbox.depth(image.stamp, std::move(image.image));
                     });
    }
    thread = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  void run(const std::stop_token& stop) noexcept {
    try {
      while (!stop.stop_requested()) {
        node.spin(kPeriod);
        const std::lock_guard lock(mutex);
        connected = node.connected() && node.publishers(stereo) > 0 &&
                    (depth.empty() || node.publishers(depth) > 0);
        faults = node.faults();
      }
    } catch (...) {
      // Memory is used up: what was known is known, and nothing is connected.
      const std::lock_guard lock(mutex);
      connected = false;
    }
  }

  static constexpr double kPeriod = 0.05;  // [s]
  GazeboNode node;                         // of the thread
  std::string stereo, depth;
  mutable std::mutex mutex;
  bool connected = false;
  std::vector<std::string> faults;
  std::jthread thread;  // ends first
};

GazeboSensors::GazeboSensors(const GazeboOptions& options, SensorInbox& inbox) {
  check(options);
  impl_ = std::make_unique<Impl>(options, inbox);
}
GazeboSensors::~GazeboSensors() = default;

bool GazeboSensors::connected() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->connected;
}

std::vector<std::string> GazeboSensors::faults() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->faults;
}

}  // namespace prospect
