// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/odometry.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/stereo_odometry_options.h"
#include "perception/odometry/track.h"

namespace prospect {

/// Where a frame was taken, by the landmarks that it shows.
struct FrameLocation {
  PoseEstimate pose;  ///< parallel to the tracks that are `tracked`, in order
  int expected = 0;   ///< landmarks predicted in view
  int tracked = 0;    ///< found, and agree with the pose
  int confirmed = 0;  ///< of them, those that the right image confirms
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
  /// landmarks agree. Sets in_view, tracked, inlier, left, right and has_right of the tracks.
  FrameLocation locate(std::vector<Track>& tracks, const Eigen::Isometry3d& prior,
                       bool trust_prior) const;

 private:
  const StereoCamera& camera_;
  const StereoOdometryOptions& options_;
  double offset_;
  std::uint64_t seed_;
  const ImagePyramid& left_;
  const ImagePyramid& right_;
  OdometryTimes& times_;
};

/// The pose T_CW from which the image `before` was seen, turned so as to show the image `now`, by
/// the shift of the whole image (image_shift.h). Unchanged if the images do not show a shift.
Eigen::Isometry3d turned_by_shift(const Eigen::Isometry3d& T_CW, const PyramidLevel& before,
                                  const PyramidLevel& now, const PinholeCamera& camera);

}  // namespace prospect
