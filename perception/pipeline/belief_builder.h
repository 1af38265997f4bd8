// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/maps/belief.h"
#include "engine/maps/landmark_map.h"
#include "engine/maps/map_projection.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/odometry/odometry.h"
#include "perception/pipeline/pose_history.h"

namespace prospect {

/// Visual odometry and mapping as the Belief that the planner plans on.
///
/// W: z up, and the floor is z = 0 where B's origin is on the floor; so the odometry begins at
/// T_WC = T_BC, or at T_WB T_BC. Of the pose, B's tilt is left out. The twist is that between the
/// two newest frames whose pose was measured, until it is older than max_age; zero then.
///
/// Stamps: those of pose and landmarks are set; when the maps took in their newest scan, and when
/// the newest one came, is for the caller to set (SourceStamps).
///
/// Thread-safety: one thread at a time. Errors: the constructor throws
/// std::invalid_argument if T_BC is no rotation and translation; build() never throws.
class BeliefBuilder {
 public:
  /// T_BC: of the left camera. max_age [s].
  explicit BeliefBuilder(const Eigen::Isometry3d& T_BC, double max_age = 0.5);

  /// The belief at a frame. Maps and landmarks as they are known then, no map null. The same frame
  /// again has the same twist.
  Belief build(const OdometryFrame& frame, BeliefMaps maps, LandmarkMap landmarks);

  /// The same for a robot that has wheels, too: pose, covariance, twist and time are those of the
  /// fusion, and landmarks, which the odometry knows in a frame of its own since a loss, are moved
  /// to where the robot sees them: by T_WB(fused) T_WB(odometry)^-1, in the plane. Localization is
  /// the worse of the two states.
  Belief build(const OdometryFrame& frame, const FusedOdometry& fused, BeliefMaps maps,
               LandmarkMap landmarks);

  /// The same where the pose comes from outside: body measured at `stamp` [s], with the covariance
  /// of (x, y, z, yaw). There are no landmarks.
  Belief build(double stamp, const BodyPose& body, const Eigen::Matrix4d& covariance,
               BeliefMaps maps);

  /// The next pose has nothing to do with those before: it has jumped.
  void restart() {
    has_pose_ = false;
    twist_ = {};
  }

 private:
  enum class PoseKind {
    kPredicted,
    kMeasured,
    kRestarted  ///< measured, after a jump
  };
  /// Takes a pose for the twist, if it is one that was measured.
  void move(double stamp, const Pose& pose, PoseKind kind);

  Eigen::Isometry3d T_BC_;
  double max_age_;
  bool has_pose_ = false;
  double stamp_ = 0.0;  // of the newest measured pose
  Pose pose_;
  Twist twist_;
};

}  // namespace prospect
