#include "engine/blocked_motion.h"

#include <Eigen/Geometry>
#include <cmath>

namespace prospect {

std::optional<Eigen::Vector3d> BlockedMotion::update(double stamp, const Pose& pose,
                                                     const Twist& command) {
  const Eigen::Vector3d velocity =
      Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()) * command.linear;
  if (!std::isfinite(stamp) || !pose.position.allFinite() || !velocity.allFinite()) {
    reset();
    return std::nullopt;
  }
  const bool joins = last_ && stamp > last_->stamp && stamp - last_->stamp <= kLongest;
  if (joins) asked_ += 0.5 * (stamp - last_->stamp) * (last_->velocity + velocity);
  last_ = Step{stamp, velocity};
  const bool moved = !joins || (pose.position - anchor_).norm() > kMoved;
  const bool blocked = !moved && asked_.norm() >= kAsked;
  if (!moved && !blocked) return std::nullopt;
  const Eigen::Vector3d direction = asked_.normalized();
  anchor_ = pose.position;
  asked_.setZero();
  if (!blocked) return std::nullopt;
  return direction;
}

}  // namespace prospect
