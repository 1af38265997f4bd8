#include "runtime/pose_jump.h"

#include <cmath>

#include "models/formatted.h"
#include "perception/odometry/body_pose.h"

namespace prospect {

std::string PoseJumpWatch::add(ExternalPose& pose) {
  constexpr double kWindow = 0.5;  // [s]
  constexpr double kFaster = 1.5;  // than its model allows: the pose is measured, and so is time
  std::string jumped;
  if (pose.T_WB.matrix().allFinite()) {
    const Seen now{pose.stamp, body_pose(pose.T_WB)};
    while (!seen_.empty() && !(now.stamp - seen_.front().stamp <= kWindow)) {
      if (seen_.size() == 1) break;  // the newest is compared with at any age
      seen_.pop_front();
    }
    for (const Seen& before : seen_) {
      const double dt = now.stamp - before.stamp;
      if (!(dt > 0.0)) continue;
      const double way = (now.pose.position - before.pose.position).head<2>().norm();
      const double turn = std::abs(std::remainder(now.pose.yaw - before.pose.yaw, 2.0 * M_PI));
      if (way <= options_.distance + kFaster * options_.speed * dt &&
          turn <= options_.turn + kFaster * options_.yaw_rate * dt) {
        continue;
      }
      jumped = formatted("by %.2f m and %.2f rad in %.2f s", way, turn, dt);
      ++jumps_.count;
      jumps_.distance += way;
      jumps_.turn += turn;
      seen_.clear();
      break;
    }
    seen_.push_back(now);
  }
  pose.jumps = jumps_;
  return jumped;
}

}  // namespace prospect
