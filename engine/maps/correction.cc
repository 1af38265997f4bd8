// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/correction.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/maps/pose_error.h"
#include "engine/task/moved.h"
#include "models/body_transform.h"
#include "models/formatted.h"
#include "models/one_line.h"

namespace prospect {
namespace {

/// T_AC from T_AB and T_BC, in the plane; z is that of T_BC.
Pose joined(const Pose& ab, const Pose& bc) {
  Pose ac;
  ac.position.head<2>() = moved(bc.position.head<2>(), ab);
  ac.position.z() = bc.position.z();
  ac.yaw = ab.yaw + bc.yaw;
  return ac;
}

Pose inverted(const Pose& ab) {
  Pose ba;
  ba.yaw = -ab.yaw;
  ba.position.head<2>() = moved(-ab.position.head<2>(), ba);
  return ba;
}

/// What it does in the plane.
Pose planar(const Eigen::Isometry3d& T) {
  Pose pose;
  pose.position.head<2>() = T.translation().head<2>();
  pose.yaw = std::atan2(T.linear()(1, 0), T.linear()(0, 0));
  return pose;
}

/// Where W lies in M afterwards.
Pose corrected(const Correction& c, const Pose& origin) {
  Pose now = c.kind == CorrectionKind::kMap ? joined(planar(c.T_new_old), origin)
                                            : joined(origin, planar(c.T_new_old));
  now.position.z() = 0.0;
  now.yaw = std::remainder(now.yaw, 2.0 * M_PI);
  return now;
}

/// Of what others have written.
std::string shown(const std::string& why) {
  constexpr std::size_t kMost = 160;
  return one_line(why.substr(0, kMost));
}

}  // namespace

std::string to_text(const TakenCorrection& c) {
  return formatted("the map was corrected by %.2f m and %.1f degrees", c.distance,
                   c.turn * 180.0 / M_PI) +
         (c.why.empty() ? "" : ": " + c.why);
}

Pose MapFrame::to_map(const Pose& in_W) const { return joined(origin, in_W); }
Pose MapFrame::to_W(const Pose& in_M) const { return joined(inverted(origin), in_M); }
Eigen::Vector2d MapFrame::to_map(const Eigen::Vector2d& in_W) const { return moved(in_W, origin); }
Eigen::Vector2d MapFrame::to_W(const Eigen::Vector2d& in_M) const {
  return moved(in_M, inverted(origin));
}
Pose MapFrame::map_in_W() const { return inverted(origin); }

Pose origin_of(const MapFrame* frame) { return frame != nullptr ? frame->origin : Pose(); }

void Corrections::expect() {
  if (!frame_) frame_ = std::make_shared<const MapFrame>();
}

std::string Corrections::objection(const Correction& c, const Pose& robot) const {
  if (!std::isfinite(c.stamp)) return "its stamp is not finite";
  if (!is_pose(c.T_new_old)) return "it is no rotation and translation, finite";
  const double tilt = std::acos(std::clamp(c.T_new_old.linear()(2, 2), -1.0, 1.0));
  if (tilt > kTilt) {
    return formatted("it tilts the map by %.1f degrees; expected at most %.1f, as z is up in both",
                     tilt * 180.0 / M_PI, kTilt * 180.0 / M_PI);
  }
  if (!is_pose_covariance(c.covariance)) return "its covariance is none";
  for (const AnchorMove& move : c.anchors) {
    if (!is_pose(move.T_new_old))
      return "it moves an anchor by no rotation and translation, finite";
  }
  const Pose origin = origin_of(frame_.get()), before = joined(origin, robot);
  const double distance =
      (joined(corrected(c, origin), robot).position - before.position).head<2>().norm();
  if (!(distance <= kFarthestMove)) {
    return formatted("it moves the robot by %.4g m in the map; expected at most %g m", distance,
                     kFarthestMove);
  }
  if (frame_ && frame_->newest && !(c.stamp >= frame_->newest->stamp + kPeriod * (1.0 - 1e-9))) {
    return formatted("it comes %.3g s after the one before; expected %g s at least",
                     c.stamp - frame_->newest->stamp, kPeriod);
  }
  return "";
}

Corrections::Answer Corrections::take(const Correction& c, const Pose& robot) {
  MapFrame next = frame_ ? *frame_ : MapFrame();
  Answer answer;
  if (std::string wrong = objection(c, robot); !wrong.empty()) {
    answer = {CorrectionVerdict::kRefused, "a correction of the map is refused: " + wrong};
    ++next.refused;
  } else if (c.kind != CorrectionKind::kMap) {
    answer = {CorrectionVerdict::kCannotFollow,
              std::string("a correction of ") +
                  (c.kind == CorrectionKind::kRobot ? "the robot's place in what it has drawn"
                                                    : "parts of the map against each other") +
                  " cannot be followed: what was drawn does not move, or moves already"};
    ++next.cannot_follow;
  }
  if (answer.verdict != CorrectionVerdict::kTaken) {
    if (!c.why.empty()) answer.why += " (" + shown(c.why) + ')';
    next.refusal = answer.why;
    frame_ = std::make_shared<const MapFrame>(std::move(next));
    return answer;
  }
  take_into(next, c, robot);
  frame_ = std::make_shared<const MapFrame>(std::move(next));
  return answer;
}

void Corrections::take_into(MapFrame& next, const Correction& c, const Pose& robot) {
  const Pose before = next.to_map(robot);
  next.origin = corrected(c, next.origin);
  TakenCorrection taken;
  taken.stamp = c.stamp;
  const Pose after = next.to_map(robot);
  taken.distance = (after.position - before.position).head<2>().norm();
  taken.turn = std::remainder(after.yaw - before.yaw, 2.0 * M_PI);
  taken.sigma = position_sigma(c.covariance);
  taken.why = shown(c.why);
  next.newest = std::move(taken);
  ++next.taken;
}

std::string Corrections::refuse(const Correction& c, const Pose& robot) {
  std::string wrong = objection(c, robot);
  if (wrong.empty()) return wrong;
  wrong = "a correction of the map is refused: " + wrong;
  if (!c.why.empty()) wrong += " (" + shown(c.why) + ')';
  MapFrame next = frame_ ? *frame_ : MapFrame();
  ++next.refused;
  next.refusal = wrong;
  frame_ = std::make_shared<const MapFrame>(std::move(next));
  return wrong;
}

void Corrections::cannot(const std::string& why) {
  if (frame_ && frame_->refusal == why) return;
  MapFrame next = frame_ ? *frame_ : MapFrame();
  ++next.cannot_follow;
  next.refusal = why;
  frame_ = std::make_shared<const MapFrame>(std::move(next));
}

void Corrections::followed(const Correction& c, const Pose& robot,
                           std::shared_ptr<const PlaceMoves> how) {
  MapFrame next = frame_ ? *frame_ : MapFrame();
  take_into(next, c, robot);
  next.moved_places.push_back({next.taken, std::move(how)});
  if (next.moved_places.size() > MapFrame::kMostMoved)
    next.moved_places.erase(next.moved_places.begin());
  frame_ = std::make_shared<const MapFrame>(std::move(next));
}

}  // namespace prospect
