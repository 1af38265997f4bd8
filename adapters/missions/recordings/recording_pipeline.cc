// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/recording_pipeline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/maps/planar_error.h"
#include "models/body_transform.h"
#include "perception/odometry/body_pose.h"

namespace prospect {

PerceptionOptions recording_options(const Eigen::Isometry3d& start, bool loops) {
  PerceptionOptions options;
  options.stereo_mount.T_BC.setIdentity();
  options.wheels = false;
  options.start_in_space = start;
  options.max_leap = std::numeric_limits<double>::infinity();
  options.loops = options.poses_drift = loops;
  if (loops) options.pose_degraded = options.pose_lost = 1000.0;  // however far they have drifted
  return options;
}

Eigen::Matrix4d PoseDrift::at(const Eigen::Isometry3d& T_WB) {
  const Pose now = body_pose(T_WB), before = before_.value_or(now);
  const WheelNoise noise;
  const Eigen::Vector2d way = (now.position - before.position).head<2>();
  const double d = way.norm(), w = std::abs(std::remainder(now.yaw - before.yaw, 2.0 * M_PI));
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(now.yaw).toRotationMatrix();
  P_ = carried(P_, way);
  P_.topLeftCorner<2, 2>() +=
      d * R *
      Eigen::DiagonalMatrix<double, 2>(noise.along * noise.along, noise.across * noise.across) *
      R.transpose();
  P_(2, 2) += noise.turn * noise.turn * w + noise.heading * noise.heading * d;
  before_ = now;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  const Eigen::Vector3i planar(0, 1, 3);
  covariance(planar, planar) = 0.5 * (P_ + P_.transpose());
  return covariance;
}

MapRunFrame map_at(PerceptionPipeline& perception, double stamp, const Eigen::Isometry3d* T_WB,
                   PoseDrift& drift, const std::function<InputResult()>& take) {
  MapRunFrame frame;
  if (perception.straight_map()) frame.anchor = perception.straight_map()->open_anchor();
  InputResult pose{InputState::kTaken, ""};
  if (T_WB) {
    ExternalPose measured{.stamp = stamp, .T_WB = *T_WB};
    if (perception.straight_map()) measured.covariance = drift.at(*T_WB);
    pose = perception.external_pose(measured);
  }
  const InputResult result = pose.state == InputState::kTaken ? take() : pose;
  if (result.state != InputState::kLate && perception.mapped().stamp == stamp) {
    frame.mapped = perception.mapped();
    return frame;
  }
  frame.mapped.stamp = stamp;
  frame.mapped.T_WC = perception.mapped().T_WC;
  frame.mapped.reason = result.reason;
  return frame;
}

void straighten(PerceptionPipeline& perception, MapRun& run) {
  const StraightMap* map = perception.straight_map();
  if (!map) return;
  perception.finish();
  MapRunLoops loops{map->found(), map->used()};
  for (MapRunFrame& frame : run.frames) {
    Eigen::Isometry3d& T_WC = frame.mapped.T_WC;
    const PlanarMove to_W = map->moved(frame.anchor);
    const Eigen::Vector3d before = T_WC.translation();
    T_WC = body_transform({{to_W.shift.x(), to_W.shift.y(), 0.0}, to_W.yaw}) * T_WC;
    loops.farthest = std::max(loops.farthest, (T_WC.translation() - before).norm());
  }
  run.loops = loops;
  run.maps = perception.map().snapshot();
}

}  // namespace prospect
