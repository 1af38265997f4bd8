// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/true_run.h"

#include <cmath>
#include <deque>
#include <utility>
#include <vector>

#include "adapters/robots/simulator/kinematic_robot.h"
#include "adapters/robots/simulator/seen_area.h"

namespace prospect {
namespace {

constexpr double kLook = 0.2;  // [s] between two looks of the depth cameras

Pose between(const Pose& a, const Pose& b, double share) {
  Pose pose;
  pose.position = a.position + share * (b.position - a.position);
  pose.yaw = a.yaw + share * std::remainder(b.yaw - a.yaw, 2.0 * M_PI);
  return pose;
}

HeightSlice slice_of(const RobotDescription& robot) {
  const VerticalExtent slice = robot.slice();
  return {slice.z_min, slice.z_max, std::nullopt};
}

}  // namespace

struct TrueRun::Impl {
  Impl(const World& world, const RobotDescription& robot, const DepthCameraOptions& looks,
       Poses told_poses)
      : told(std::move(told_poses)),
        base_height(robot.base_height()),
        contact(world, robot.shape, base_height),
        seen(world, slice_of(robot)) {
    for (const DepthSensor& sensor : robot.depth_sensors()) {
      DepthCameraOptions rays = looks;
      if (!cameras.empty()) rays.footprint = sensor.footprint, set_resolution(rays);
      cameras.emplace_back(world, rays, sensor.mount, 1 + cameras.size());
    }
  }

  void set_reachable(const Grid<std::uint8_t>& reachable) {
    seen.set_reachable(reachable);
    truth.coverage = seen.coverage();
  }

  void add(const GazeboTruth::Stamped& newest) {
    Pose pose = newest.pose;
    pose.position.z() = base_height;
    if (!poses.empty()) {
      truth.path_length += (pose.position - truth.pose.position).head<2>().norm();
    }
    truth.pose = pose;
    const bool touches_now = contact.in_contact(pose);
    truth.collisions += touches_now && !touches;
    touches = touches_now;
    if (newest.stamp >= next_look) {
      next_look = newest.stamp + kLook;
      for (DepthCamera& camera : cameras) seen.look(camera, pose);
    }
    poses.push_back({newest.stamp, pose});
    while (poses.size() > 2 && poses[1].stamp < newest.stamp - kRemembered) poses.pop_front();
  }

  /// Nearest in time of what is remembered; requires one.
  Pose at(double stamp) const {
    for (std::size_t n = poses.size() - 1; n > 0; --n) {
      const GazeboTruth::Stamped &a = poses[n - 1], &b = poses[n];
      if (stamp < a.stamp) continue;
      return between(a.pose, b.pose, std::min(1.0, (stamp - a.stamp) / (b.stamp - a.stamp)));
    }
    return poses.front().pose;
  }

  static constexpr double kRemembered = 5.0;  // [s]
  Poses told;
  double base_height;
  ContactTest contact;
  std::vector<DepthCamera> cameras;  // by number
  SeenArea seen;
  std::deque<GazeboTruth::Stamped> poses;
  bool touches = false, lost = false;
  double next_look = -1e9;
  TrueState truth;
};

TrueRun::TrueRun(const World& world, const RobotDescription& robot, const DepthCameraOptions& looks,
                 const Grid<std::uint8_t>& reachable, Poses poses)
    : impl_(std::make_unique<Impl>(world, robot, looks, std::move(poses))) {
  impl_->set_reachable(reachable);
}
TrueRun::~TrueRun() = default;

TrueState TrueRun::at(const Belief& belief) {
  for (const GazeboTruth::Stamped& newest : impl_->told()) impl_->add(newest);
  TrueState& truth = impl_->truth;
  truth.coverage = impl_->seen.coverage();
  truth.seen_area = impl_->seen.area();
  if (!impl_->poses.empty()) {
    const Pose then = impl_->at(belief.stamp);
    truth.localization_error = (belief.pose.position - then.position).head<2>().norm();
  }
  const bool lost = belief.localization == Localization::kLost;
  truth.losses += lost && !impl_->lost;
  impl_->lost = lost;
  return truth;
}

TrueState TrueRun::newest() const { return impl_->truth; }

}  // namespace prospect
