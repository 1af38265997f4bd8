// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/belief_builder.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "models/camera.h"
#include "perception/odometry/body_pose.h"

namespace prospect {

using Eigen::Isometry3d;

BeliefBuilder::BeliefBuilder(const Isometry3d& T_BC, double max_age)
    : T_BC_(T_BC), max_age_(max_age) {
  validate(CameraMount{T_BC});
}

void BeliefBuilder::move(double stamp, const Pose& pose, PoseKind kind) {
  const bool measured = kind != PoseKind::kPredicted;
  if (measured && !(has_pose_ && stamp == stamp_)) {
    const double dt = stamp - stamp_;
    twist_ = {};
    if (has_pose_ && kind != PoseKind::kRestarted && dt > 0.0 && dt <= max_age_) {
      const double turn = std::remainder(pose.yaw - pose_.yaw, 2.0 * M_PI);
      // In the body frame half way, in which an arc's velocity is straight ahead.
      twist_.linear = Eigen::AngleAxisd(-(pose_.yaw + 0.5 * turn), Eigen::Vector3d::UnitZ()) *
                      (pose.position - pose_.position) / dt;
      twist_.yaw_rate = turn / dt;
    }
    has_pose_ = true;
    stamp_ = stamp;
    pose_ = pose;
  } else if (!measured && !(stamp - stamp_ <= max_age_)) {
    twist_ = {};
  }
}

Belief BeliefBuilder::build(double stamp, const BodyPose& body, const Eigen::Matrix4d& covariance,
                            BeliefMaps maps) {
  move(stamp, body.pose,
       body.state != Localization::kLost ? PoseKind::kMeasured : PoseKind::kPredicted);
  Belief belief;
  belief.stamp = belief.stamps.pose = belief.stamps.landmarks = stamp;
  belief.pose = body.pose;
  belief.covariance = covariance;
  belief.twist = twist_;
  belief.localization = body.state;
  belief.localization_source = LocalizationSource::kExternal;
  belief.octree = std::move(maps.octree);
  belief.voxels = std::move(maps.voxels);
  belief.ground = std::move(maps.ground);
  return belief;
}

Belief BeliefBuilder::build(const OdometryFrame& frame, BeliefMaps maps, LandmarkMap landmarks) {
  const Pose pose = body_pose(frame.T_WC * T_BC_.inverse());
  const bool measured = frame.state != Localization::kLost && frame.tracked > 0;
  move(frame.stamp, pose,
       !measured         ? PoseKind::kPredicted
       : frame.restarted ? PoseKind::kRestarted
                         : PoseKind::kMeasured);
  Belief belief;
  belief.stamp = frame.stamp;
  belief.stamps.pose = belief.stamps.landmarks = frame.stamp;
  belief.pose = pose;
  belief.covariance = body_covariance(frame.T_WC, T_BC_, frame.covariance);
  belief.twist = twist_;
  belief.localization = frame.state;
  belief.tracked_features = frame.tracked;
  belief.octree = std::move(maps.octree);
  belief.voxels = std::move(maps.voxels);
  belief.ground = std::move(maps.ground);
  belief.landmarks = std::make_shared<const LandmarkMap>(std::move(landmarks));
  return belief;
}

Belief BeliefBuilder::build(const OdometryFrame& frame, const FusedOdometry& fused, BeliefMaps maps,
                            LandmarkMap landmarks) {
  const Pose seen = body_pose(frame.T_WC * T_BC_.inverse());
  Isometry3d T = Isometry3d::Identity();
  T.linear() =
      Eigen::AngleAxisd(fused.pose.yaw - seen.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation().head<2>() =
      fused.pose.position.head<2>() - (T.linear() * seen.position).head<2>();
  for (Landmark& l : landmarks.landmarks) {
    l.position = T * l.position;
    l.covariance = (T.linear() * l.covariance * T.linear().transpose()).eval();
    l.creation_direction = T.linear() * l.creation_direction;
  }
  Belief belief = build(frame, std::move(maps), std::move(landmarks));
  belief.stamp = fused.stamp;
  belief.stamps.pose = fused.newest;
  belief.pose = fused.pose;
  const Eigen::Vector3i planar(0, 1, 3);
  belief.covariance.setZero();
  belief.covariance(planar, planar) = fused.covariance;
  belief.twist = fused.twist;
  belief.localization = std::max(frame.state, fused.state);
  return belief;
}

}  // namespace prospect
