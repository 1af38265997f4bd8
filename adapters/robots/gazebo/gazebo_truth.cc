// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_truth.h"

#include <cmath>
#include <mutex>
#include <utility>

#include "adapters/robots/gazebo/gazebo_messages.h"
#include "adapters/robots/gazebo/gazebo_receiver.h"

namespace prospect {

struct GazeboTruth::Impl {
  explicit Impl(const GazeboOptions& options) : receiver(options) {
    receiver.subscribe(
        "pose/info", "gazebo.msgs.PosesStamped",
        [this, name = options.model](std::string_view message) { add(message, name); });
    receiver.start();
  }

  void add(std::string_view message, const std::string& name) {
    const GazeboPoses all = read_gazebo_poses(message);
    const GazeboPoses::Named* const robot = all.find(name);
    if (robot == nullptr) return;
    const Eigen::Vector3d ahead = robot->orientation * Eigen::Vector3d::UnitX();
    const std::lock_guard lock(mutex);
    if (poses.size() == kMost) poses.pop_front();
    poses.push_back({all.stamp, {robot->position, std::atan2(ahead.y(), ahead.x())}});
  }

  static constexpr std::size_t kMost = 100000;
  std::mutex mutex;
  std::deque<Stamped> poses;
  GazeboReceiver receiver;  // its thread ends first
};

GazeboTruth::GazeboTruth(const GazeboOptions& options) : impl_(std::make_unique<Impl>(options)) {}
GazeboTruth::~GazeboTruth() = default;
GazeboTruth::GazeboTruth(GazeboTruth&&) noexcept = default;

std::deque<GazeboTruth::Stamped> GazeboTruth::take() {
  const std::lock_guard lock(impl_->mutex);
  return std::exchange(impl_->poses, {});
}

}  // namespace prospect
