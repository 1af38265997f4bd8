// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <unordered_set>
#include <vector>

#include "adapters/missions/recordings/odometry_consistency.h"
#include "adapters/missions/recordings/pose_consistency.h"
#include "adapters/missions/recordings/reliability.h"
#include "engine/features/visibility_prediction.h"
#include "engine/maps/landmark_map.h"
#include "models/camera.h"
#include "perception/odometry/motion_noise.h"
#include "perception/odometry/stereo_odometry.h"

namespace prospect {

/// What this odometry can track, in the words of the planner's prediction: limits in scale and view
/// are those of its tracker, depths those of its matcher, noise that of its options. Image border
/// and widths are the planner's.
VisibilityParameters odometry_visibility(const StereoCamera& camera,
                                         const StereoOdometryOptions& options);

/// What the planner predicts (engine/features/visibility_prediction.h) of a left camera that goes
/// along a path.
struct VisibilityForecast {
  Eigen::VectorXd probability;  ///< pi_i of each landmark at the end of the path
  /// Sigma_rel there, over (x, y, z, yaw) in the frame L of the first pose: x along its optical
  /// axis, y left, z up [m, rad].
  Eigen::Matrix4d covariance;
};

/// `path`: poses T_WC, the first is now; two at least. Sigma_rel is propagated over the whole path
/// by the planner's own recursion; for pi_i the last pose counts with all its six degrees of
/// freedom. A landmark counts as visible that the left image shows, as it does for the odometry. No
/// occlusion. Throws std::invalid_argument for a shorter path, and as VisibilityPrediction does.
VisibilityForecast forecast_visibility(const std::vector<Landmark>& landmarks,
                                       const StereoCamera& camera,
                                       const std::vector<Eigen::Isometry3d>& path,
                                       const VisibilityParameters& parameters);

/// The same covariance, with `tracked` points in view at each pose of the path. Throws
/// std::invalid_argument for a shorter path and for another number of counts.
Eigen::Matrix4d forecast_motion(const StereoCamera& camera,
                                const std::vector<Eigen::Isometry3d>& path,
                                const VisibilityParameters& parameters,
                                const std::vector<double>& tracked);

/// A motion of the left camera as (x, y, z, yaw) in L.
Eigen::Vector4d level_motion(const Eigen::Isometry3d& T_C0C1);

struct OdometryCalibrationOptions {
  std::vector<int> horizons = {5, 10, 20};  ///< [frames]
  int stride = 2;                           ///< predictions are made at every so many frames
  double constant_survival = 0.9;           ///< to compare with: the same for all landmarks
};

/// Predictions against what came of them, for one horizon.
struct VisibilityAgreement {
  int horizon = 0;          ///< [frames]
  CountAgreement count;     ///< landmarks of frame n that are tracked at n + horizon, one pair an n
  Reliability reliability;  ///< of each landmark
};

struct OdometryCalibrationResult {
  std::vector<VisibilityAgreement> online;    ///< with the survival that landmarks() gives
  std::vector<VisibilityAgreement> constant;  ///< with constant_survival and the noise assumed
  /// Sigma_rel against the error of the odometry's motion over each horizon, where the true motion
  /// is known, with as many points in view as were tracked on the way: with the noise that the
  /// odometry had measured when the prediction was made (motion_noise.h), and with the one that the
  /// planner assumes.
  std::vector<PoseConsistency> motion, motion_assumed;
  ConsistencyResult consistency;  ///< of the odometry's own covariances
  int predictions = 0;            ///< of one landmark at one horizon
  /// Landmarks that the odometry gave up for another in the same image cell before their time came,
  /// though it could track them. What would have become of them is not known: they do not count.
  int given_up = 0;
};

/// Watches an odometry at work and compares what the planner would have predicted with what
/// happened: from frame n, with the landmarks known then and the motion that was to come, which are
/// tracked at frame n + H?
///
/// The covariances of the planner and of the odometry are held against the errors of the odometry
/// where the truth is known; a truth with errors of its own makes both look too sure.
///
/// The motion is the true one where it is known, laid onto the pose that the odometry had at n,
/// else the odometry's own. Frames at which the odometry is lost predict nothing, but do count as
/// outcome: nothing is tracked. Deterministic. Throws std::invalid_argument for horizons or a
/// stride below 1.
class OdometryCalibration {
 public:
  OdometryCalibration(const StereoCamera& camera, const StereoOdometryOptions& odometry_options,
                      const OdometryCalibrationOptions& options = {});

  /// After each frame that `odometry` has processed, in order.
  void add(const StereoOdometry& odometry, const OdometryFrame& frame,
           const std::optional<Eigen::Isometry3d>& true_T_WC);

  /// Another recording begins, by a new odometry; what was found so far is kept.
  void begin_recording();

  OdometryCalibrationResult result() const;

 private:
  struct Origin {
    int frame;
    std::vector<std::shared_ptr<const LandmarkMap>> maps;  ///< for each horizon
    OdometryNoise noise;
    std::unordered_set<std::uint64_t> given_up;
  };
  struct Scores {
    std::vector<double> expected_count, expected_count_constant, count;
    std::vector<double> probability, probability_constant;
    std::vector<char> tracked;
    std::vector<double> motion, motion_assumed;
  };
  void compare(const Origin& origin, std::size_t horizon,
               const std::unordered_set<std::uint64_t>& tracked);

  StereoCamera camera_;
  VisibilityParameters parameters_;
  OdometryCalibrationOptions options_;
  int longest_ = 0;
  int frames_ = 0;
  double last_stamp_ = 0.0;
  std::deque<Origin> origins_;
  std::deque<Eigen::Isometry3d> estimates_;              ///< the newest longest_ + 1
  std::deque<std::optional<Eigen::Isometry3d>> truths_;  ///< parallel
  std::deque<char> lost_;                                ///< parallel
  std::deque<double> tracked_;                           ///< parallel: points
  OdometryConsistency consistency_;
  MotionNoise noise_;
  std::vector<Scores> scores_;  ///< one a horizon
  int given_up_ = 0;
};

}  // namespace prospect
