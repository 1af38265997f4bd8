#include "adapters/gazebo/gazebo_truth.h"

#include <cmath>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "adapters/gazebo/gazebo_messages.h"
#include "runtime/clock.h"

namespace prospect {

struct GazeboTruth::Impl {
  explicit Impl(const GazeboOptions& options) : node(options.address) {
    node.subscribe("/gazebo/" + gazebo_world_name(options, node) + "/pose/info",
                   "gazebo.msgs.PosesStamped",
                   [this, name = options.model](std::string_view message) { add(message, name); });
    thread = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) node.spin(kPeriod);
    });
  }

  void add(std::string_view message, const std::string& name) {
    const GazeboPoses all = read_gazebo_poses(message);
    const GazeboPoses::Named* const robot = all.find(name);
    if (robot == nullptr) return;
    const Eigen::Vector3d ahead = robot->orientation * Eigen::Vector3d::UnitX();
    const std::lock_guard lock(mutex);
    if (poses.size() == kMost) poses.erase(poses.begin());
    poses.push_back({all.stamp, clock.now(), {robot->position, std::atan2(ahead.y(), ahead.x())}});
  }

  static constexpr double kPeriod = 0.05;  // [s]
  static constexpr std::size_t kMost = 100000;
  GazeboNode node;  // of the thread
  SteadyClock clock;
  std::mutex mutex;
  std::vector<Stamped> poses;
  std::jthread thread;  // ends first
};

GazeboTruth::GazeboTruth(const GazeboOptions& options) {
  check(options);
  impl_ = std::make_unique<Impl>(options);
}
GazeboTruth::~GazeboTruth() = default;

std::vector<GazeboTruth::Stamped> GazeboTruth::take() {
  const std::lock_guard lock(impl_->mutex);
  return std::exchange(impl_->poses, {});
}

}  // namespace prospect
