// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/maps/belief.h"
#include "models/types.h"
#include "perception/odometry/odometry.h"

namespace prospect {

/// What visual odometry says of one frame: the motion of B in the plane since a reference frame.
struct VisualMotion {
  double stamp = 0.0;  ///< [s], of the frame
  Localization state = Localization::kLost;
  /// (x, y, yaw) of B now in B at the reference frame [m, m, rad]; not used if lost.
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Standard deviation of what all lengths may be off by together, beside the calibration; share
  /// of them. Cameras that are out of step, or may be.
  double scale_sigma = 0.0;
  /// This frame, not lost, is the reference of those to come, as a keyframe is.
  bool becomes_reference = false;
  /// This frame is the first of a map: the reference of those to come, while `motion` says nothing.
  bool begins_map = false;
};

/// The motion of B in the plane of its x and y axes between two poses of its camera, C.
///   M = T_BC T_CW(reference) T_WC(now) T_BC^-1,   motion = (M_x, M_y, yaw of M)
/// covariance: 6x6 of xi = (t, omega) in C now with T_CW <- exp(xi) T_CW, as OdometryFrame gives
/// it; as M <- M exp(-Ad(T_BC) xi), to first order it is carried over to the motion. Fills motion
/// and covariance.
void set_motion(VisualMotion& visual, const Eigen::Isometry3d& T_WC_reference,
                const Eigen::Isometry3d& T_WC, const Eigen::Matrix<double, 6, 6>& covariance,
                const Eigen::Isometry3d& T_BC);

/// What the frames of visual odometry, in order, say of the motion of a body that carries its left
/// camera at T_BC: since the newest keyframe before them. One thread at a time.
class VisualMotionReader {
 public:
  explicit VisualMotionReader(const Eigen::Isometry3d& T_BC) : T_BC_(T_BC) {}
  VisualMotion read(const OdometryFrame& frame);

  /// What a planar estimate of B's pose says of the motion of C: the pose of C when B is at `now`
  /// in C when B was at `before`; for StereoOdometry::process().
  Eigen::Isometry3d camera_motion(const Pose& before, const Pose& now) const;

 private:
  Eigen::Isometry3d T_BC_;
  Eigen::Isometry3d T_WC_reference_ = Eigen::Isometry3d::Identity();
  bool has_reference_ = false;
};

}  // namespace prospect
