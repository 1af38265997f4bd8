// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/missions/recordings/odometry_consistency.h"
#include "adapters/missions/recordings/time_percentiles.h"
#include "adapters/missions/recordings/trajectory_error.h"
#include "perception/fusion/inertial_witness.h"
#include "perception/odometry/stereo_odometry.h"

namespace prospect {

/// What one pass of the odometry (PerceptionPipeline, with a body that is free in space and is the
/// left camera) over a recording gives. Poses are causal: each as it was known at
/// its frame, nothing is changed afterwards.
struct OdometryRun {
  std::vector<OdometryFrame> frames;
  Trajectory trajectory;        ///< of frames that are not lost, from the first true pose if known
  std::vector<PosePair> pairs;  ///< with ground truth; empty: there is none
  /// Likewise if w were first in the truth's quaternions; empty where their order is stated.
  std::vector<PosePair> pairs_w_first;
  ConsistencyResult consistency;   ///< of the covariances, with ground truth
  std::vector<std::string> notes;  ///< pairs that could not be read: lost, with the reason
  /// Of an IMU beside the cameras; none so far.
  struct Imu {
    std::size_t samples = 0, taken = 0;
    std::string reason;                                   ///< why the newest that was left out was
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< [rad/s], in the left camera
    double gyro_bias_sigma = 0.0;
    double tilt = 0.0;  ///< [rad] between up by it at the end and at first; NaN: not known
    int against = 0;    ///< frames that it contradicts
  };
  std::optional<Imu> imu;
  bool cancelled = false;  ///< it ends before the last frame
};

/// What there is to see after each frame of a run; valid during the call alone.
struct OdometryStep {
  int done = 0;  ///< frames, this one included
  const OdometryFrame& frame;
  const StereoOdometry& odometry;
  const StereoDataset::Pair& images;
  std::optional<Eigen::Isometry3d> true_T_WC;  ///< if known at this time
};

/// Runs the odometry over a recording, from frame `first`, at most `max_frames` (0: all).
/// `observe`, if any, is called after each frame that can be read; `cancelled`, if any, is asked
/// before each. One thread; the same recording gives the same poses. An IMU of the recording is
/// held against the images (PerceptionPipeline::imu).
OdometryRun run_odometry(const StereoDataset& dataset, const StereoOdometryOptions& options = {},
                         int first = 0, int max_frames = 0,
                         const std::function<void(const OdometryStep&)>& observe = {},
                         const std::function<bool()>& cancelled = {},
                         const InertialOptions& inertial = {});

/// Counts and errors of a run. Errors and lengths are NaN without two poses to measure them from
/// (without ground truth, or where all else was lost), or where the path is too short.
struct OdometrySummary {
  int frames = 0, ok = 0, degraded = 0, lost = 0, losses = 0, restarts = 0, keyframes = 0;
  double covered = 0.0;        ///< share of the frames that have a pose: not lost
  double covered_truth = 0.0;  ///< share of the frames whose pose was held against the truth
  /// Most of the frames have no pose, or all but one: what there is says little of the recording.
  bool mostly_lost = false;
  std::string lost_reason;  ///< the most frequent reason of lost frames; empty if none was lost
  double estimated_length = 0.0, true_length = 0.0;  ///< [m]
  ScaleAgreement scale;                              ///< of estimated with true lengths
  AbsoluteError ate_first, ate_fit;
  EndError end;
  RelativeError rpe_1m, rpe_10m;
  /// Of every frame, and `keyframe` of what keyframes cost beside it; `frame` is the sum of the
  /// first three.
  TimePercentiles pyramids, tracking, pose, keyframe, frame;
  /// Processor time of frames without and of frames with a keyframe, all included.
  TimePercentiles processor, processor_keyframe;
  double disparity_offset = 0.0, disparity_offset_sigma = 0.0;  ///< [px], at the end; NaN: all lost
  /// By how much later the right image is taken than the left one, at the end [s], NaN: not known;
  /// and why that is too much, empty if it is not.
  double camera_time_offset = 0.0, camera_time_offset_sigma = 0.0;
  std::string out_of_step;
  /// Not empty: why the ground truth's quaternions have w first, which is no truth as it was read.
  std::string truth_turns_wrong;
  ConsistencyResult consistency;
};
OdometrySummary summarize(const OdometryRun& run);

/// One row a frame: number, stamp, state, reason, keyframe, counts, position and sigma. No
/// wall-clock times, so the same recording gives the same bytes.
std::string frames_csv(const OdometryRun& run);

}  // namespace prospect
