// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/following_monitor.h"

#include <Eigen/Geometry>
#include <cmath>

namespace prospect {

std::optional<Eigen::Vector2d> FollowingMonitor::update(double stamp, const Pose& pose,
                                                        const Twist& command) {
  const Eigen::Vector2d position = pose.position.head<2>();
  const Eigen::Vector2d velocity = Eigen::Rotation2Dd(pose.yaw) * command.linear.head<2>();
  if (!std::isfinite(stamp) || !position.allFinite() || !velocity.allFinite()) {
    reset();
    return std::nullopt;
  }
  const bool joins = last_ && stamp > last_->stamp && stamp - last_->stamp <= kLongest;
  if (joins) asked_ += 0.5 * (stamp - last_->stamp) * (last_->velocity + velocity);
  last_ = Step{stamp, velocity};
  const bool stands = joins && (position - anchor_).norm() <= kMoved;
  if (stands && asked_.norm() < kAsked) return std::nullopt;
  const Eigen::Vector2d direction = asked_.normalized();
  anchor_ = position;
  asked_.setZero();
  if (!stands) return std::nullopt;
  noticed_at_ = stamp;
  return direction;
}

}  // namespace prospect
