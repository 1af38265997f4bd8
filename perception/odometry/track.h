// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/point_observation.h"

namespace prospect {

/// Where landmarks were made: the image their patches are taken from, and the pose of its camera.
/// Nobody changes it once landmarks refer to it.
struct Anchor {
  std::uint64_t id = 0;
  ImagePyramid left;
  Eigen::Isometry3d T_CW = Eigen::Isometry3d::Identity();
};

/// A landmark of the stereo odometry, and what the newest frame shows of it.
struct Track {
  std::uint64_t id = 0;
  std::shared_ptr<const Anchor> anchor;
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();  ///< in the anchor's left image
  double disparity = 0.0;                           ///< measured there, before correction [px]
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of the disparity there, see SlantedPatch
  /// What the patch's texture adds to the variance of the disparity [px^2].
  double disparity_variance = 0.0;
  Eigen::Vector3d in_anchor = Eigen::Vector3d::Zero();   ///< [m], in the anchor's camera frame
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< [m], in W
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< [m^2], in W
  /// Where it was at the last keyframe [px], if it was.
  Eigen::Vector2f at_keyframe = Eigen::Vector2f::Zero();
  bool seen_at_keyframe = false;
  bool moving = false;  ///< found to move against the world (second_motion.h)
  int misses = 0;       ///< in a row
  int found = 0;        ///< in how many frames

  // The newest frame.
  bool in_view = false;
  bool tracked = false;                            ///< its patch was found in the left image
  bool inlier = false;                             ///< and agrees with the pose
  Eigen::Vector2f left = Eigen::Vector2f::Zero();  ///< [px], if tracked
  float right = 0.0f;                              ///< column in the right image [px]
  bool has_right = false;
  bool in_right = false;   ///< its patch was found in the right image, in whatever row
  float row_error = 0.0f;  ///< and how much lower there [px]
  /// What the patch's texture adds to the covariance of `left` and the variance of `right` [px^2].
  Eigen::Matrix2d left_covariance = Eigen::Matrix2d::Zero();
  double right_variance = 0.0;
};

/// Where a left image shows a landmark, and how its patch is warped there and in the right image: A
/// of patch_tracker.h for both.
struct TrackPrediction {
  Eigen::Vector2f pixel;  ///< [px]
  Eigen::Matrix2f A, A_right;
};

/// Prediction at the pose T_CW. The patch is taken for a piece of a plane, the one that the slope
/// of its disparity says: with the anchor's point X at depth z and disparity d, and the slope g, X
/// changes over the anchor's image by
///   dX/du = (z/fx) e_x - (g_u/d) X,   dX/dv = (z/fy) e_y - (g_v/d) X.
/// Empty if the landmark is out of view, or seen by more than the factor max_scale nearer or
/// farther than at its anchor.
std::optional<TrackPrediction> predict_track(const Track& track, const Eigen::Isometry3d& T_CW,
                                             const StereoCamera& camera, double max_scale);

/// Whether nothing but chance can keep the landmark from being tracked at T_CW: its patch is well
/// within the image, at a scale well within the limits.
bool in_full_view(const Track& track, const Eigen::Isometry3d& T_CW, const StereoCamera& camera,
                  double max_scale);

/// Position and covariance from what was measured at the anchor, eqs. (1) and (2), with the
/// disparity's zero corrected by `offset` [px] (disparity_offset.h).
void place_track(Track& track, const StereoCamera& camera, double offset);

/// What the newest frame saw of some landmarks, as pose_estimation.h takes it.
struct TrackObservations {
  std::vector<PointObservation> seen;
  std::vector<int> index;  ///< of each one's track
};

/// `sigma`: standard deviations of (u, v, d) at the anchor [px] that all landmarks have in common,
/// to which each one's texture adds its own; `offset` as in place_track().
///
/// Of those that are tracked and do not move.
TrackObservations observe_tracks(const std::vector<Track>& tracks, const Eigen::Vector3d& sigma,
                                 double offset);
/// Of these, which are tracked.
TrackObservations observe_tracks(const std::vector<Track>& tracks, std::vector<int> index,
                                 const Eigen::Vector3d& sigma, double offset);

/// [px] by which a point `position` in W moves in the left image from one pose to another. None: it
/// is less than 0.1 m before one of them.
std::optional<double> image_flow(const StereoCamera& camera, const Eigen::Vector3d& position,
                                 const Eigen::Isometry3d& from_T_CW,
                                 const Eigen::Isometry3d& to_T_CW);
/// [px] of flow, in the median, below which a camera seems to rest.
inline constexpr double kRestingFlow = 1.0;

}  // namespace prospect
