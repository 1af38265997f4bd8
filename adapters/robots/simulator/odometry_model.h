// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "engine/maps/belief.h"
#include "models/camera.h"
#include "models/types.h"

namespace prospect {

class Knobs;

struct OdometryOptions {
  bool perfect = false;  ///< the estimate is the truth, always localized
  /// A keyframe is taken when the robot has moved or turned this far since the last one: none while
  /// standing still, so no drift at rest.
  double keyframe_distance = 0.15;  ///< [m]
  double keyframe_angle = 0.15;     ///< [rad]
  /// Root-mean-square error of one keyframe at 200 well-spread points: horizontal position [m] and
  /// heading [rad]. Measured: medians of the odometry's error over 2 m while it is not lost
  /// (docs/results/simulator.md, "One fidelity against the other").
  double position_sigma = 0.0014;
  double heading_sigma = 0.00014;
  /// What a mission errs by on its whole way, drawn once, one standard deviation: of the length of
  /// motions [share], of their direction in the body [rad], and of turns [share]. Measured: as
  /// above, of cameras whose calibration is as good as real ones' (camera_effects.h).
  double scale_error = 0.006;
  double direction_error = 0.004;
  double turn_error = 0.0025;
  /// Tracked features: StereoOdometryOptions::lost_points and degraded_points.
  int lost_below = 12;
  int degraded_below = 40;
  /// Dead reckoning while lost, one standard deviation: of the distance and of the angle turned
  /// [share], and of the heading per metre driven [rad/m].
  double reckoning_distance = 0.02;
  double reckoning_angle = 0.01;
  double reckoning_heading = 0.005;
  /// Standard deviations, a square root of a radian turned, of what a turn adds after a loss:
  /// position [m] and heading [rad]. They fall by 1/e over so much turning [rad]. Measured: the
  /// fusion with wheels learns their scale again by what vision says on turns, and moves the pose
  /// by what the reckoning erred.
  double after_loss_position = 0.0075;
  double after_loss_heading = 0.0015;
  double after_loss_turning = 10.0;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, OdometryOptions& options);

/// Visual odometry as a model of its error: how the estimate departs from the truth, given the
/// features that are really tracked.
///
/// At each keyframe the motion since the last one is known up to e = (e_x, e_y, e_yaw) ~ N(0, Q),
/// in the body frame at the new keyframe:
///   p' = p + R(yaw) dp + R(yaw + dyaw) e_xy,   yaw' = yaw + dyaw + e_yaw,
///   Q  = S I^{-1} S,   I = sum_i H_i^T W H_i,   H_i = d(u, v, d)_i / d(x, y, yaw),
///   W  = diag(1/sigma_u^2, 1/sigma_v^2, 1/sigma_d^2) / 2,
/// I being the information of the reprojection errors of the tracked points (both views are noisy,
/// hence the half), and S = diag(s_p, s_p, s_yaw) chosen so that 200 points spread evenly over the
/// image and over depths of 1 to 5 m give exactly position_sigma and heading_sigma. Hence Q falls
/// as 1/N for points alike, and grows for far or clustered ones. Standard deviations of Q are
/// bounded by 5 cm and 0.05 rad. Below lost_below tracked points the motion is reckoned from the
/// wheels, with covariance P of the reckoning and, on top, of lost_below reference points, so that
/// being lost is never better than seeing a few. A motion that vision measured errs besides by what
/// a mission's calibration does, c = (scale, direction, turn) ~ N(0, C), C of the variances of
/// scale_error, direction_error and turn_error, with d = R(yaw)^T dp and J a quarter turn:
///   e_xy = R(dyaw)^T (c_1 d + c_2 J d),   e_yaw = c_3 dyaw,
/// which grows with the way, and not with its root. While points are tracked, wheels and vision are
/// fused, (Q^-1 + P^-1)^-1 instead of Q, which counts where points are few or clustered. After a
/// loss a turn by dyaw adds |dyaw| exp(-2 T / T_0) diag(a_p^2 / 2, a_p^2 / 2, a_yaw^2), T being
/// what has been turned since, T_0 after_loss_turning. Between keyframes the motion since the last
/// one is taken as exact: its error does not accumulate.
///
/// Covariance of (x, y, z, yaw) from the start: first-order composition of the same Q, and
/// K C K^T, K composed of the derivatives of these e by c; z is known.
/// Source: calibration against StereoOdometry on rendered images; the model is our choice.
/// Thread-safety: one thread. Deterministic in (options, seed, sequence of calls).
class OdometryModel {
 public:
  /// Throws std::invalid_argument on options out of range.
  OdometryModel(const OdometryOptions& options, const StereoCamera& stereo,
                const CameraMount& mount, const Pose& start, std::uint64_t seed);

  /// One image, taken at a true pose, with the tracked points' true positions in C [m].
  /// Returns true if it became a keyframe.
  bool image(const Pose& true_pose, const std::vector<Eigen::Vector3d>& points_C);

  /// The pose was found again in the map of landmarks: the estimate at `true_pose` becomes `found`,
  /// and the covariance that of a pose here which owes its errors to that at which localization was
  /// lost, plus `covariance`, of (x, y, yaw), with which it was found in that map. Of several
  /// losses it is the first, if the count of features wavered about the limit before the pose was
  /// found.
  void relocalize(const Pose& true_pose, const Pose& found, const Eigen::Matrix3d& covariance);

  /// The robot is carried to `true_pose`, and nothing measures that: the estimate stays.
  void carry(const Pose& from, const Pose& true_pose);

  /// The search was given up: what the loss added to the error stays.
  void accept_drift() { adrift_ = false; }

  /// Estimate at a true pose reached since the last keyframe.
  Pose estimate(const Pose& true_pose) const;
  /// Covariance of its error in (x, y, z, yaw), [m] and [rad].
  Eigen::Matrix4d covariance(const Pose& true_pose) const;
  /// Of what has been added to the error since localization was lost, (x, y, z, yaw) in W, on top
  /// of 1 cm and 5 mrad; of no meaning unless a search for the pose is under way.
  const Eigen::Matrix4d& drift_covariance() const { return drift_covariance_; }
  Localization localization() const { return localization_; }
  int losses() const { return losses_; }
  int keyframes() const { return keyframes_; }

  /// Q for a set of points in C [m^2, m rad, rad^2], of (x, y, yaw) in B; bounded, never singular.
  Eigen::Matrix3d keyframe_covariance(const std::vector<Eigen::Vector3d>& points_C) const;
  /// The 200 points of the calibration, in C.
  static std::vector<Eigen::Vector3d> reference_points(const StereoCamera& stereo, int count = 200);

 private:
  Eigen::Vector3d calibration_sigma() const;
  Eigen::Matrix3d information(const std::vector<Eigen::Vector3d>& points_C) const;

  OdometryOptions options_;
  StereoCamera stereo_;
  CameraMount mount_;
  std::mt19937_64 noise_;
  double position_scale_ = 1.0;
  double heading_scale_ = 1.0;
  Eigen::Matrix3d lost_covariance_ = Eigen::Matrix3d::Zero();  // of lost_below reference points
  Pose true_keyframe_;
  Pose keyframe_;
  Eigen::Vector3d calibration_;                           // c
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Zero();  // at keyframe_, without c
  Eigen::Matrix<double, 4, 3> by_calibration_ = Eigen::Matrix<double, 4, 3>::Zero();  // K
  Eigen::Vector3d place_at_loss_ = Eigen::Vector3d::Zero();
  Eigen::Matrix4d covariance_at_loss_ = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> by_calibration_at_loss_ = Eigen::Matrix<double, 4, 3>::Zero();
  Eigen::Matrix4d drift_covariance_ = Eigen::Matrix4d::Zero();
  double turned_since_loss_ = 0.0;  // [rad]
  bool adrift_ = false;             // lost, and neither found again nor given up since
  Localization localization_ = Localization::kOk;
  int losses_ = 0;
  int keyframes_ = 0;
};

}  // namespace prospect
