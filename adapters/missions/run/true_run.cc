#include "adapters/missions/run/true_run.h"

#include <cmath>
#include <deque>
#include <utility>

#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/kinematic_robot.h"
#include "adapters/robots/simulator/seen_area.h"

namespace prospect {
namespace {

constexpr double kLook = 0.2;  // [s] between two looks of the depth camera

Pose between(const Pose& a, const Pose& b, double share) {
  Pose pose;
  pose.position = a.position + share * (b.position - a.position);
  pose.yaw = a.yaw + share * std::remainder(b.yaw - a.yaw, 2.0 * M_PI);
  return pose;
}

HeightSlice slice_of(const Configuration& c) {
  const VerticalExtent slice = c.robot.slice();
  return {slice.z_min, slice.z_max, std::nullopt};
}

}  // namespace

struct TrueRun::Impl {
  Impl(const World& world, const Configuration& c, GazeboTruth its_truth)
      : gazebo(std::move(its_truth)),
        base_height(c.robot.base_height()),
        contact(world, c.robot.shape, base_height),
        reachable(told_area(reachable_area(world, c), c)),
        camera(world, c.simulator.depth, c.robot.depth_mount, 1),
        seen(world, slice_of(c)) {
    seen.set_reachable(reachable.cells);
    truth.coverage = seen.coverage();
  }

  void add(const GazeboTruth::Stamped& told) {
    Pose pose = told.pose;
    pose.position.z() = base_height;
    if (!poses.empty()) {
      truth.path_length += (pose.position - truth.pose.position).head<2>().norm();
    }
    truth.pose = pose;
    const bool touches_now = contact.in_contact(pose);
    truth.collisions += touches_now && !touches;
    touches = touches_now;
    if (told.stamp >= next_look) {
      next_look = told.stamp + kLook;
      seen.look(camera, pose);
    }
    poses.push_back({told.stamp, pose});
    while (poses.size() > 2 && poses[1].stamp < told.stamp - kRemembered) poses.pop_front();
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
  GazeboTruth gazebo;
  double base_height;
  ContactTest contact;
  ReachableArea reachable;
  DepthCamera camera;
  SeenArea seen;
  std::deque<GazeboTruth::Stamped> poses;
  bool touches = false;
  double next_look = -1e9;
  SimulatedTruth truth;
};

TrueRun::TrueRun(const World& world, const Configuration& configuration, GazeboTruth truth)
    : impl_(std::make_unique<Impl>(world, configuration, std::move(truth))) {}
TrueRun::~TrueRun() = default;

SimulatedTruth TrueRun::at(const Belief& belief) {
  for (const GazeboTruth::Stamped& told : impl_->gazebo.take()) impl_->add(told);
  SimulatedTruth& truth = impl_->truth;
  truth.coverage = impl_->seen.coverage();
  truth.seen_area = impl_->seen.area();
  if (!impl_->poses.empty()) {
    const Pose then = impl_->at(belief.stamp);
    truth.localization_error = (belief.pose.position - then.position).head<2>().norm();
  }
  return truth;
}

SimulatedTruth TrueRun::truth() const { return impl_->truth; }

const ReachableArea& TrueRun::reachable() const { return impl_->reachable; }

}  // namespace prospect
