// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "engine/maps/localization.h"
#include "models/types.h"
#include "perception/odometry/motion_in_view.h"

namespace prospect {

/// Where a body is believed to be.
struct BodyPose {
  Pose pose;  ///< in the plane
  /// T_WB in space; of a body that moves in the plane, that of `pose`.
  Eigen::Isometry3d T_WB = Eigen::Isometry3d::Identity();
  Localization state = Localization::kOk;
  /// What was in view then, in W; null: nothing moves.
  std::shared_ptr<const MotionInView> motion{};
};

/// Where a body was of late, as it was believed then; nothing is corrected afterwards.
/// Thread-safety: one thread. Never throws. Deterministic.
class PoseHistory {
 public:
  /// span [s]: times up to so long before the newest are known.
  explicit PoseHistory(double span) : span_(span) {}

  /// Stamps are finite and increase [s].
  void add(double stamp, const BodyPose& pose);
  /// Between two poses: positions straight on, yaw and rotation each the shorter way round, the
  /// worse state, the motion in view of the nearer one. Nothing before the first and after the
  /// newest.
  std::optional<BodyPose> at(double stamp) const;
  std::optional<double> newest() const;

 private:
  double span_;
  std::deque<std::pair<double, BodyPose>> poses_;
};

}  // namespace prospect
