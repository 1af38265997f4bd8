// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "perception/odometry/calibration_error.h"
#include "perception/odometry/camera_time_offset.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/disparity_offset.h"
#include "perception/odometry/keyframe_policy.h"
#include "perception/odometry/motion_prior.h"
#include "perception/odometry/patch_tracker.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/shared_errors.h"
#include "perception/odometry/stereo_matcher.h"
#include "perception/odometry/track_survival.h"

namespace prospect {

class Knobs;

struct StereoOdometryOptions {
  CornerDetectorOptions corners;
  StereoMatcherOptions matching;
  PatchTrackerOptions tracking;
  PoseEstimatorOptions pose;
  KeyframePolicyOptions keyframes;
  DisparityOffsetOptions disparity_offset;
  CameraTimeOffsetOptions time_offset;
  CalibrationErrorOptions calibration;
  SharedErrorOptions shared_errors;
  MotionPriorOptions motion;
  TrackSurvival::Options survival;

  int pyramid_levels = 5;
  /// Standard deviations [px] of a new landmark's coordinates that all have in common. (u, v) are
  /// by definition where its patch was taken; what they carry is how the patch is seen from
  /// elsewhere.
  double sigma_corner = 0.1;
  double sigma_disparity = 0.15;
  /// Times the covariance that the grey levels leave to a patch's position (patch_alignment.h), as
  /// if neighbouring pixels were independent: how many of them are alike.
  double texture_noise = 10.0;
  double max_scale = 1.6;  ///< a landmark seen this much nearer or farther is made anew
  int max_misses = 3;      ///< frames in a row without a track before a landmark is dropped

  /// When a pose is not trusted.
  int lost_points = 12;      ///< fewer: lost
  int degraded_points = 40;  ///< fewer: degraded
  double lost_share = 0.15;  ///< of the landmarks in view that are tracked and agree
  double degraded_share = 0.4;
  double lost_right_share = 0.2;  ///< of the tracked ones that the right image confirms
  double degraded_right_share = 0.5;
  double max_sigma_position = 0.25;     ///< [m] since the last keyframe; above: lost
  double max_speed = 50.0;              ///< [m/s]
  double max_turn_rate = 6.0;           ///< [rad/s]
  double max_acceleration = 30.0;       ///< [m/s^2]
  double max_turn_acceleration = 60.0;  ///< [rad/s^2]
  double max_gap = 2.6;                 ///< of the usual time between frames; above: degraded
  int recovery_keyframes = 5;           ///< that are tried while lost
  /// Lost for so long [s]: a new map is begun at the last good pose; 0: never.
  double restart_after = 2.0;

  /// Keyframes find their landmarks on a second thread, while frames go on being located; they are
  /// entered at the next frame after. Poses then depend on how long that takes, in their last
  /// millimetres. False: in process(), and the same frames give the same bits.
  bool background_mapping = false;

  std::uint64_t seed = 1;
};

/// The knobs (models/knobs.h); the seed is not one.
void describe(Knobs& knobs, StereoOdometryOptions& options);

}  // namespace prospect
