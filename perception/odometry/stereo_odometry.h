#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/disparity_offset.h"
#include "perception/odometry/keyframe_policy.h"
#include "perception/odometry/odometry.h"
#include "perception/odometry/patch_tracker.h"
#include "perception/odometry/pose_estimation.h"
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
  TrackSurvival::Options survival;

  int pyramid_levels = 5;
  /// Standard deviations [px] of a new landmark's coordinates. (u, v) are by definition where its
  /// patch was taken; what they carry is only the patch's finite extent.
  double sigma_corner = 0.05;
  double sigma_disparity = 0.25;
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

/// Visual odometry from rectified stereo pairs, after eVO (Sanfourche, Vittori, Le Besnerais 2013):
/// a sparse map of landmarks, made by stereo matching at keyframes, and the pose of every frame
/// from where they are found again.
///
/// Each frame: landmarks are predicted with the motion that is given, else the last one, their
/// patches - always those of the
/// keyframe that made them, so tracks do not creep - warped by the predicted change of scale and
/// rotation and aligned with the left image (patch_tracker.h); RANSAC; then, from that pose, the
/// ones missed again, and all of them in the right image; robust refinement with both
/// (pose_estimation.h). Keyframes (keyframe_policy.h) fill the image cells that hold no landmark.
///
/// States. Ok: enough points, spread over the image, agree. Degraded: the pose is measured, but by
/// few points, on a part of the image, or after a gap; or the image did not change at all and the
/// pose is held. Lost: no pose is measured; the last good one is held and its covariance grows;
/// every frame is tried against the newest keyframes, and after restart_after a new map begins,
/// flagged. A pose that implies an impossible motion is not taken.
///
/// Thread-safety: one thread calls process(); landmarks() snapshots may be read anywhere. Errors:
/// the constructor throws std::invalid_argument on a wrong camera or option; process() never throws
/// for any image: one of a wrong size or time makes the frame lost, with the reason. Determinism:
/// same frames, same bits, but for `times`, unless background_mapping is on. The two threads then
/// share only what neither changes: images, pyramids, and the anchor's pose.
class StereoOdometry final : public Odometry {
 public:
  explicit StereoOdometry(const StereoCamera& camera, const StereoOdometryOptions& options = {},
                          const Eigen::Isometry3d& initial_T_WC = Eigen::Isometry3d::Identity());
  ~StereoOdometry() override;
  StereoOdometry(StereoOdometry&&) noexcept;
  StereoOdometry& operator=(StereoOdometry&&) noexcept;

  OdometryFrame process(double stamp, const ImageView& left, const ImageView& right,
                        const std::optional<Eigen::Isometry3d>& motion = {}) override;
  /// Made on demand. Survival is learned from this odometry's own tracks (track_survival.h).
  std::shared_ptr<const LandmarkMap> landmarks(double horizon = 1.0) const override;
  const std::vector<LandmarkSighting>& sightings() const override;
  const std::vector<std::uint64_t>& given_up() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
