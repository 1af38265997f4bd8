// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/odometry.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/second_motion.h"
#include "perception/odometry/stereo_odometry_options.h"
#include "perception/odometry/track.h"

namespace prospect {

/// Where a frame was taken, by the landmarks that it shows.
struct FrameLocation {
  PoseEstimate pose;  ///< parallel to the tracks that are `tracked`, in order
  int expected = 0;   ///< landmarks predicted in view
  int tracked = 0;    ///< found, and agree with the pose
  int confirmed = 0;  ///< of them, those that the right image confirms
  /// Another motion that landmarks agree on: the pose if they were the world, and the logarithm of
  /// the odds of `pose` against it.
  struct Second {
    Eigen::Isometry3d T_CW = Eigen::Isometry3d::Identity();
    double log_odds = 0.0;
  };
  std::optional<Second> second;
};

/// Locates one frame. Keeps references to what it is made from; made for a frame and thrown away.
/// Deterministic but for `times`. Not thread-safe.
class FrameLocator {
 public:
  /// `offset`: correction of the disparity's zero [px]; `seed`: of RANSAC.
  FrameLocator(const StereoCamera& camera, const StereoOdometryOptions& options, double offset,
               std::uint64_t seed, const ImagePyramid& left, const ImagePyramid& right,
               OdometryTimes& times)
      : camera_(camera),
        options_(options),
        offset_(offset),
        seed_(seed),
        left_(left),
        right_(right),
        times_(times) {}

  /// The pose by these landmarks, near `prior`: coarse tracking from there; RANSAC and refinement;
  /// tracking in both images from that pose; refinement. A prior that is not trusted is taken to
  /// be far off: tracking begins at the coarsest level. So it does if less than half of the
  /// landmarks agree. Levels of the pyramids finer than `level` are not looked at, and then no
  /// other motion is looked for. Sets in_view, tracked, inlier, left, right and has_right of the
  /// tracks.
  ///
  /// Of those that do not agree, and those that moved before, at least 12 and a tenth as many may
  /// agree on another motion. Then the likelier one of the two is the world's
  /// (world_log_odds()), and the others' tracks are `moving`. Where the camera seems to rest, those
  /// that are not found where they were are looked for by the shift of their part of the image: a
  /// camera is at rest only if all of the view is, and not a thing that it carries.
  FrameLocation locate(std::vector<Track>& tracks, const Eigen::Isometry3d& prior, bool trust_prior,
                       const MotionExpectation& expected, int level = 0) const;

 private:
  /// The other motion, if there is one; `world` becomes the likelier one.
  std::optional<FrameLocation::Second> find_second(std::vector<Track>& tracks,
                                                   const TrackObservations& observed,
                                                   const PoseEstimatorOptions& estimation,
                                                   const MotionExpectation& expected,
                                                   PoseEstimate& world) const;
  /// Of the tracks that are in view but not where they were at the frame before, if the pose says
  /// that the camera rests: looks for them where their part of the image has gone. Their places.
  std::vector<int> find_missing(std::vector<Track>& tracks, const MotionExpectation& expected,
                                const Eigen::Isometry3d& T_CW) const;

  const StereoCamera& camera_;
  const StereoOdometryOptions& options_;
  double offset_;
  std::uint64_t seed_;
  const ImagePyramid& left_;
  const ImagePyramid& right_;
  OdometryTimes& times_;
};

/// The pose T_CW from which the image `before` was seen, turned so as to show the image `now`, by
/// the shift of the whole image, or of a part of it (image_shift.h). Unchanged if the images do not
/// show a shift.
Eigen::Isometry3d turned_by_shift(const Eigen::Isometry3d& T_CW, const PyramidLevel& before,
                                  const PyramidLevel& now, const PinholeCamera& camera,
                                  const std::vector<char>& part = {});

}  // namespace prospect
