// SPDX-License-Identifier: Apache-2.0
#include "runtime/pose_velocity.h"

#include <cmath>

#include "perception/odometry/body_pose.h"

namespace prospect {

bool PoseVelocity::add(double stamp, const Eigen::Isometry3d& T_WB) {
  constexpr double kWindow = 0.3, kApart = 0.6;  // [s]
  constexpr std::size_t kLeast = 3;
  if (!std::isfinite(stamp) || !T_WB.matrix().allFinite()) return false;
  if (!seen_.empty() && !(stamp > seen_.back().stamp)) return false;
  ExternalPose judged{.stamp = stamp, .T_WB = T_WB};
  const bool jumped = !jumps_.add(judged).empty();
  if (jumped || (!seen_.empty() && stamp - seen_.back().stamp > kApart)) seen_.clear();
  const Pose pose = body_pose(T_WB);
  const double before = seen_.empty() ? pose.yaw : seen_.back().yaw;
  seen_.push_back({stamp, pose.position.x(), pose.position.y(),
                   before + std::remainder(pose.yaw - before, 2.0 * M_PI)});
  while (seen_.size() > kLeast && stamp - seen_.front().stamp > kWindow) seen_.pop_front();
  if (seen_.size() < kLeast) return true;

  double time = 0.0, yaw = 0.0;
  for (const Seen& s : seen_) time += s.stamp, yaw += s.yaw;
  const auto count = static_cast<double>(seen_.size());
  time /= count, yaw /= count;
  double squares = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Seen& s : seen_) {
    const double t = s.stamp - time;
    squares += t * t;
    sum += t * Eigen::Vector3d(s.x - seen_.front().x, s.y - seen_.front().y, s.yaw - yaw);
  }
  const Eigen::Vector2d moved = Eigen::Rotation2Dd(-yaw) * Eigen::Vector2d(sum.head<2>() / squares);
  velocity_ = {{moved.x(), moved.y(), 0.0}, sum.z() / squares};
  return true;
}

}  // namespace prospect
