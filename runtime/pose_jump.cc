// SPDX-License-Identifier: Apache-2.0
#include "runtime/pose_jump.h"

#include <cmath>

#include "models/formatted.h"
#include "perception/odometry/body_pose.h"

namespace prospect {

bool PoseJumpWatch::apart(const Pose& a, const Pose& b, double dt) const {
  constexpr double kFaster = 1.5;  // than its model allows: the pose is measured, and so is time
  return (a.position - b.position).head<2>().norm() >
             options_.distance + kFaster * options_.speed * dt ||
         std::abs(std::remainder(a.yaw - b.yaw, 2.0 * M_PI)) >
             options_.turn + kFaster * options_.yaw_rate * dt;
}

std::string PoseJumpWatch::add(ExternalPose& pose) {
  constexpr double kWindow = 0.5;  // [s]
  std::string jumped;
  if (pose.T_WB.matrix().allFinite()) {
    Seen now{pose.stamp, body_pose(pose.T_WB), std::nullopt};
    if (pose.T_OB && pose.T_OB->matrix().allFinite()) now.by_odometry = body_pose(*pose.T_OB);
    while (!seen_.empty() && !(now.stamp - seen_.front().stamp <= kWindow)) {
      if (seen_.size() == 1) break;  // the newest is compared with at any age
      seen_.pop_front();
    }
    for (const Seen& before : seen_) {
      const double dt = now.stamp - before.stamp;
      if (!(dt > 0.0) || !apart(now.pose, before.pose, dt)) continue;
      if (now.by_odometry && before.by_odometry &&
          !apart(*now.by_odometry, *before.by_odometry, dt)) {
        ++corrections_;
      } else {
        const double way = (now.pose.position - before.pose.position).head<2>().norm();
        const double turn = std::abs(std::remainder(now.pose.yaw - before.pose.yaw, 2.0 * M_PI));
        jumped = formatted("by %.2f m and %.2f rad in %.2f s", way, turn, dt);
        ++jumps_.count;
        jumps_.distance += way;
        jumps_.turn += turn;
      }
      seen_.clear();
      break;
    }
    seen_.push_back(now);
  }
  pose.jumps = jumps_;
  pose.corrections = corrections_;
  return jumped;
}

}  // namespace prospect
