// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/pose_check.h"

namespace prospect {
namespace {

constexpr double kSlackPosition = 0.05;  // [m] of a pose, beside what the speed allows
constexpr double kSlackRotation = 0.05;  // [rad]

}  // namespace

const char* not_mapped_at(Localization pose) {
  // What a wrong pose enters is not taken out again by a right one.
  if (pose == Localization::kDegraded) return "the pose is degraded";
  return pose == Localization::kLost ? "the pose is lost" : nullptr;
}

const char* PoseCheck::problem(double stamp, const Eigen::Isometry3d& T) const {
  if (!is_pose(T)) return "the pose is no rotation and translation";
  // A wild pose must not become the one that others are held to.
  if (T.translation().cwiseAbs().maxCoeff() > limits_.farthest) {
    return "the pose is outside of what a map can hold";
  }
  if (any_) {
    const double dt = stamp - stamp_;
    const double moved = (T.translation() - last_.translation()).norm();
    const double turned = Eigen::AngleAxisd(last_.linear().transpose() * T.linear()).angle();
    if (moved > limits_.max_speed * dt + kSlackPosition ||
        turned > limits_.max_turn_rate * dt + kSlackRotation) {
      return "the pose jumps";
    }
  }
  return nullptr;
}

void PoseCheck::accept(double stamp, const Eigen::Isometry3d& T) {
  stamp_ = stamp;
  last_ = T;
  any_ = true;
}

}  // namespace prospect
