// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/odometry.h"
#include "perception/odometry/stereo_odometry_options.h"

namespace prospect {

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
  void expect(const std::optional<Eigen::Isometry3d>& motion) override;
  /// Made on demand. Survival is learned from this odometry's own tracks (track_survival.h).
  std::shared_ptr<const LandmarkMap> landmarks(double horizon = 1.0) const override;
  const std::vector<LandmarkSighting>& sightings() const override;
  const std::vector<std::uint64_t>& given_up() const override;

  /// Nothing where either pose was not measured, after a new map, or if it is longer ago than 20
  /// frames.
  std::optional<Eigen::Matrix<double, 6, 6>> covariance_since(int frames) const override;

  /// Nothing where the newest pose was not measured.
  std::optional<MotionAhead> motion_ahead() const override;

  /// Of what moves those that are found, or were in one of the max_misses frames before: then where
  /// they are if they went on.
  MotionInView motion_in_view() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
