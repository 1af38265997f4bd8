// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_transforms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>
#include <string_view>
#include <vector>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/tf2_msgs.h"

namespace prospect {

struct DdsTransforms::Impl {
  struct Held {
    std::string to, from;
    Eigen::Isometry3d T;
    std::optional<double> moved_since;  // [s]
  };
  struct Followed {
    std::string to, from;
    std::function<void(double, const Eigen::Isometry3d&)> told;
    double stamp = -std::numeric_limits<double>::infinity();  // [s] of the newest
  };

  void take(std::string_view cdr, const std::string& name, bool fixed) {
    Elements elements("transforms");
    const std::vector<RosTransform> transforms = read_ros_transforms(cdr, name, elements);
    add(transforms, name, fixed);
    for (Followed& one : followed) tell(one);
    if (elements.bad() > 0) throw InputError(elements.first());
  }

  void add(const std::vector<RosTransform>& transforms, const std::string& name, bool fixed) {
    const std::lock_guard lock(mutex);
    for (const RosTransform& t : transforms) {
      if (!is_known(t.T)) continue;
      frames.insert(t.child);
      if (frames.size() > kMostFrames) {
        throw InputError(name + ": more than " + std::to_string(kMostFrames) +
                         " frames; expected those of one robot");
      }
      if (fixed) {
        tree.add_static(t.parent, t.child, t.T);
      } else {
        tree.add(t.parent, t.child, t.stamp, t.T);
        newest_stamp = std::max(newest_stamp, t.stamp);
      }
    }
    if (!fixed) tree.forget_before(newest_stamp - kKept);
  }

  void tell(Followed& one) {
    std::optional<Eigen::Isometry3d> T;
    {
      const std::lock_guard lock(mutex);
      const std::optional<double> newest = tree.newest_stamp(one.to, one.from);
      if (!newest || !(*newest > one.stamp)) return;
      one.stamp = *newest;
      T = tree.find(one.to, one.from, *newest);
    }
    if (T) one.told(one.stamp, *T);
  }

  std::optional<Eigen::Isometry3d> newest(const std::string& to, const std::string& from) const {
    return tree.nearest(to, from, newest_stamp, std::numeric_limits<double>::infinity());
  }

  static constexpr std::size_t kMostFrames = 10'000;
  static constexpr double kKept = 5.0;   // [s]
  static constexpr double kReach = 0.2;  // [s]
  mutable std::mutex mutex;
  TransformTree tree;
  std::set<std::string> frames;
  double newest_stamp = 0.0;  // [s] of what moves
  std::string topic;
  std::vector<Held> held;
  std::vector<Followed> followed;  // of the node's thread
};

DdsTransforms::DdsTransforms(DdsNode& node, const std::string& tf, const std::string& tf_static)
    : impl_(std::make_shared<Impl>()) {
  impl_->topic = tf;
  const auto impl = impl_;
  const auto subscribe = [&](const std::string& topic, const DdsQos& qos, bool fixed) {
    node.subscribe(topic, ros::definition_of<ros::TFMessage>(), qos,
                   [impl, fixed](std::string_view cdr, const std::string& name) {
                     impl->take(cdr, name, fixed);
                   });
  };
  subscribe(tf_static, kStaticTransformQos, true);
  subscribe(tf, DdsQos{false, false, 100}, false);
}
DdsTransforms::~DdsTransforms() = default;

std::optional<Eigen::Isometry3d> DdsTransforms::find(const std::string& to, const std::string& from,
                                                     double stamp) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->tree.nearest(to, from, stamp, Impl::kReach);
}

std::optional<Eigen::Isometry3d> DdsTransforms::newest(const std::string& to,
                                                       const std::string& from) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->newest(to, from);
}

void DdsTransforms::follow(const std::string& to, const std::string& from,
                           std::function<void(double, const Eigen::Isometry3d&)> told) {
  impl_->followed.push_back({to, from, std::move(told)});
}

void DdsTransforms::hold(const std::string& to, const std::string& from) {
  const std::lock_guard lock(impl_->mutex);
  if (const auto T = impl_->newest(to, from)) impl_->held.push_back({to, from, *T, {}});
}

std::string DdsTransforms::moved(double now) const {
  constexpr double kFar = 0.01;   // [m], [rad]
  constexpr double kLasts = 0.5;  // [s], longer than one of several transforms that is wrong
  const std::lock_guard lock(impl_->mutex);
  for (Impl::Held& held : impl_->held) {
    const Eigen::Isometry3d by =
        held.T.inverse() * impl_->newest(held.to, held.from).value_or(held.T);
    const double angle = Eigen::AngleAxisd(by.linear()).angle();
    if (by.translation().norm() <= kFar && std::abs(angle) <= kFar) {
      held.moved_since.reset();
      continue;
    }
    if (!held.moved_since) held.moved_since = now;
    if (now - *held.moved_since < kLasts) continue;
    return impl_->topic + ": '" + held.from + "' has moved in '" + held.to +
           "' since the start; expected a camera that is fixed to the body";
  }
  return {};
}

}  // namespace prospect
