// SPDX-License-Identifier: Apache-2.0
// The descriptions of options, in a library of their own: reading a configuration builds nothing
// that acts on them.

#include "models/knobs.h"
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
#include "perception/odometry/stereo_odometry.h"
#include "perception/odometry/track_survival.h"

namespace prospect {

void describe(Knobs& knobs, CornerDetectorOptions& o) {
  knobs.integer("cells", o.cells, {1, 1000000}, "1",
                "that the image is divided into: a corner each");
  knobs.number("min_strength_over_noise", o.min_strength_over_noise, {0.0, 1e6}, "1",
               "least strength of a corner, over the variance of the image's noise");
  knobs.integer("border", o.border, {0, 10000}, "px", "without corners along the image's edges");
}

void describe(Knobs& knobs, DisparityOffsetOptions& o) {
  knobs.number("prior_angle", o.prior_angle, {0.0, 100.0}, "mrad",
               "turn of the cameras towards each other; 0: it is not estimated");
  knobs.number("walk_sigma", o.walk_sigma, {0.0, 10.0}, "px",
               "by which it may wander from one update to the next");
  knobs.number("min_baseline", o.min_baseline, {0.001, 10.0}, "1",
               "share of its depth by which the camera must have moved for a landmark to speak");
  knobs.integer("min_points", o.min_points, {1, 100000}, "1", "landmarks that must speak together");
  knobs.number("max_offset", o.max_offset, {0.001, 100.0}, "px", "largest error");
}

void describe(Knobs& knobs, CameraTimeOffsetOptions& o) {
  knobs.number("prior_sigma", o.prior_sigma, {0.0, 10.0}, "s",
               "by which the right image may be taken later or earlier; 0: it is not estimated");
  knobs.number("prior_rows", o.prior_rows, {0.001, 10.0}, "px",
               "error of the rectification's rows");
  knobs.number("trust", o.trust, {0.001, 1.0}, "1", "share of what it says that evidence is worth");
  knobs.number("memory", o.memory, {1.0, 1e9}, "1", "frames that evidence is kept for");
  knobs.number("max_error", o.max_error, {0.0, 1.0}, "1",
               "share of the depth that it may cost; more: degraded");
}

void describe(Knobs& knobs, CalibrationErrorOptions& o) {
  knobs.number("principal_point", o.principal_point, {0.0, 100.0}, "px",
               "error of the calibration, each coordinate");
  knobs.number("focal_length", o.focal_length, {0.0, 1.0}, "1", "the same, of itself");
  knobs.number("baseline", o.baseline, {0.0, 1.0}, "1", "the same, of itself");
}

void describe(Knobs& knobs, SharedErrorOptions& o) {
  knobs.number("lasting", o.lasting, {0.0, 1.0}, "1",
               "of the variance of a patch's position, that is the same while it is tracked");
  knobs.number("area", o.area, {0.0, 0.5}, "1",
               "of what lasts, that patches in a sixth of the image's width and height share");
  knobs.number("image", o.image, {0.0, 0.5}, "1", "of what lasts, that all patches share");
  knobs.number("memory", o.memory, {0.0, 1.0}, "1",
               "correlation of what they share with the same at the next keyframe");
  knobs.number("left_right", o.left_right, {0.0, 0.999}, "1",
               "correlation of a patch's errors in both images");
}

void describe(Knobs& knobs, KeyframePolicyOptions& o) {
  knobs.integer("min_points", o.min_points, {0, 100000}, "1",
                "tracked; fewer: a new keyframe as soon as the view changes");
  knobs.number(
      "max_shift", o.max_shift, {0.001, 1.0}, "1",
      "of the points since the last keyframe, as a share of the image's width, that counts "
      "as such a change");
  knobs.number("min_share", o.min_share, {0.0, 1.0}, "1",
               "of the most points tracked since the last keyframe; less: a new one");
  knobs.number("min_cells", o.min_cells, {0.0, 1.0}, "1",
               "of the image's cells that held a point then; less: a new one");
  knobs.number("max_sigma", o.max_sigma, {1.0, 1e3}, "1",
               "deviation of the pose over that at the time; more: a new one");
  knobs.number("significance", o.significance, {0.0, 1e3}, "1",
               "of the motion, below which the robot stands still");
}

void describe(Knobs& knobs, MotionPriorOptions& o) {
  knobs.number("acceleration", o.acceleration, {0.001, 1e4}, "m/s2",
               "standard deviation of the camera's, each axis, before its motion was seen");
  knobs.number("turn_acceleration", o.turn_acceleration, {0.001, 1e5}, "rad/s2", "the same");
}

void describe(Knobs& knobs, PatchTrackerOptions& o) {
  knobs.number("min_texture", o.min_texture, {0.0, 1e6}, "1",
               "least texture of a patch, in squared grey levels a squared pixel");
  knobs.number("min_agreement", o.min_agreement, {0.0, 1.0}, "1", "of the final alignment");
  knobs.number("max_return", o.max_return, {0.01, 100.0}, "px",
               "of the track backwards from where it began");
  knobs.number("shift_per_level", o.shift_per_level, {0.1, 100.0}, "px",
               "that alignment may move on a level of the pyramid");
}

void describe(Knobs& knobs, PoseEstimatorOptions& o) {
  knobs.number("sigma_left", o.sigma_left, {0.001, 50.0}, "px", "noise of all tracked positions");
  knobs.number("sigma_right", o.sigma_right, {0.001, 50.0}, "px", "the same in the right image");
  knobs.integer("ransac_hypotheses", o.ransac_hypotheses, {1, 100000}, "1", "at most");
  knobs.number("ransac_confidence", o.ransac_confidence, {0.01, 0.999999}, "1",
               "that ends the search for a hypothesis");
  knobs.number("ransac_gate", o.ransac_gate, {0.1, 1e6}, "1",
               "chi squared of two coordinates up to which a point agrees with a hypothesis");
  knobs.number("final_gate", o.final_gate, {0.1, 1e6}, "1",
               "chi squared up to which a point agrees with the pose");
  knobs.number("huber", o.huber, {0.1, 100.0}, "1",
               "standard deviations beyond which a point counts less");
}

void describe(Knobs& knobs, StereoMatcherOptions& o) {
  knobs.number("max_disparity", o.max_disparity, {0.001, 1.0}, "1",
               "searched range, as a share of the image's width");
  knobs.number("min_disparity", o.min_disparity, {0.0, 1e3}, "px",
               "a farther point says nothing about depth");
  knobs.number("min_correlation", o.min_correlation, {0.0, 1.0}, "1", "of the two patches");
  knobs.number("distinctness", o.distinctness, {1.0, 1e3}, "1",
               "by which another place must agree less");
  knobs.number("max_row_error", o.max_row_error, {0.0, 100.0}, "px", "across the rows");
  knobs.number("max_inconsistency", o.max_inconsistency, {0.0, 100.0}, "px",
               "from left to right and back");
}

void describe(Knobs& knobs, TrackSurvival::Options& o) {
  knobs.number("prior_loss", o.prior_loss, {1e-6, 0.999}, "1",
               "probability that a view loses a landmark, before any is seen");
  knobs.number("prior_views", o.prior_views, {0.001, 1e6}, "1", "that this counts for");
  knobs.number("memory", o.memory, {1.0, 1e9}, "1", "frames after which a view counts for 1/e");
}

void describe(Knobs& knobs, StereoOdometryOptions& o) {
  knobs.integer("pyramid_levels", o.pyramid_levels, {2, 8}, "1", "of the images");
  knobs.number("sigma_corner", o.sigma_corner, {0.001, 50.0}, "px",
               "error of a new landmark's place in the image");
  knobs.number("sigma_disparity", o.sigma_disparity, {0.001, 50.0}, "px",
               "error of a new landmark's disparity");
  knobs.number("texture_noise", o.texture_noise, {0.0, 1e4}, "1",
               "times the variance that a patch's grey levels leave to its position");
  knobs.number("max_scale", o.max_scale, {1.01, 100.0}, "1",
               "a landmark seen this much nearer or farther is detected again");
  knobs.integer("max_misses", o.max_misses, {0, 1000}, "1",
                "frames in a row without a track before a landmark is dropped");
  knobs.integer("lost_points", o.lost_points, {0, 100000}, "1", "tracked; fewer: lost");
  knobs.integer("degraded_points", o.degraded_points, {0, 100000}, "1", "tracked; fewer: degraded");
  const auto share = [&](const char* name, double& value, const char* sentence) {
    knobs.number(name, value, {0.0, 1.0}, "1", sentence);
  };
  share("lost_share", o.lost_share,
        "of the landmarks in view that agree with the pose; less: lost");
  share("degraded_share", o.degraded_share, "the same; less: degraded");
  share("lost_right_share", o.lost_right_share,
        "of the tracked landmarks that the right image confirms; less: lost");
  share("degraded_right_share", o.degraded_right_share, "the same; less: degraded");
  knobs.number("max_sigma_position", o.max_sigma_position, {0.001, 1e3}, "m",
               "deviation since the last keyframe; above: lost");
  knobs.number("max_speed", o.max_speed, {0.01, 1e4}, "m/s", "of a possible motion");
  knobs.number("max_turn_rate", o.max_turn_rate, {0.01, 1e3}, "rad/s", "of a possible motion");
  knobs.number("max_acceleration", o.max_acceleration, {0.01, 1e5}, "m/s2", "of a possible motion");
  knobs.number("max_turn_acceleration", o.max_turn_acceleration, {0.01, 1e5}, "rad/s2",
               "of a possible motion");
  knobs.number("max_gap", o.max_gap, {1.0, 1e3}, "1",
               "of the usual time between frames; above: degraded");
  knobs.integer("recovery_keyframes", o.recovery_keyframes, {0, 1000}, "1",
                "that are tried while lost");
  knobs.number("restart_after", o.restart_after, {0.0, 1e6}, "s",
               "lost for so long, a new map is begun at the last good pose; 0: never");
  knobs.boolean("background_mapping", o.background_mapping,
                "keyframes on a second thread; true: runs are not reproducible");
  knobs.group("corners", [&] { describe(knobs, o.corners); });
  knobs.group("matching", [&] { describe(knobs, o.matching); });
  knobs.group("tracking", [&] { describe(knobs, o.tracking); });
  knobs.group("pose", [&] { describe(knobs, o.pose); });
  knobs.group("keyframes", [&] { describe(knobs, o.keyframes); });
  knobs.group("disparity_offset", [&] { describe(knobs, o.disparity_offset); });
  knobs.group("time_offset", [&] { describe(knobs, o.time_offset); });
  knobs.group("calibration", [&] { describe(knobs, o.calibration); });
  knobs.group("shared_errors", [&] { describe(knobs, o.shared_errors); });
  knobs.group("motion", [&] { describe(knobs, o.motion); });
  knobs.group("survival", [&] { describe(knobs, o.survival); });
}

}  // namespace prospect
