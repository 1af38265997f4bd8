// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "models/camera.h"
#include "perception/odometry/calibration_error.h"
#include "perception/odometry/relative_pose.h"
#include "perception/odometry/shared_errors.h"
#include "perception/places/stereo_view.h"

namespace prospect {

struct ViewAlignmentOptions {
  int most_bits = 64;         ///< by which descriptors of one point differ
  double distinctness = 0.9;  ///< the nearest descriptor over the next one, at most
  int least_agreeing = 7;     ///< pairs by descriptors alone, for a first pose
  int least_inliers = 15;
  double most_apart = 0.3;          ///< [m], of both ways
  double most_turned = 0.09;        ///< [rad], of both ways
  double most_unsure = 0.12;        ///< [m], deviation that is claimed: else it says too little
  double most_unsure_turn = 0.035;  ///< [rad]
  double sigma = 0.7;               ///< of a corner's place [pixels of its level]
  double sigma_disparity = 0.15;    ///< beside what its texture adds [px]
  SharedErrorOptions shared;
  CalibrationErrorOptions calibration;
};

/// What is known of two views before they are aligned.
struct ViewPrior {
  double disparity_offset = 0.0;  ///< to be added to all disparities (disparity_offset.h) [px]
  double disparity_offset_sigma = 0.3;      ///< of what is left of it [px]
  std::optional<Eigen::Isometry3d> b_in_a;  ///< where b is expected
};

struct ViewAlignment {
  RelativePose measured;  ///< camera b in camera a
  int inliers = 0;        ///< of the way that has fewer
};

/// Whether two views show the same, and from where.
///
/// 1. Corners are paired whose descriptors are each other's nearest, and clearly nearer than those
///    of any other place. RANSAC gives a first pose of b from where a has the corners in space
///    (ransac_pose()); where it does not and b is expected somewhere, the corners are paired again
///    with those that lie near where they are expected.
/// 2. From that pose every corner of a that has a depth is looked for in b, near where it should be
///    and about as large: there hardly any other looks like it, so it need not be distinct. Views
///    from afar, of which few descriptors are each other's nearest, gain most.
/// 3. Likewise the corners of b in a. Each way needs least_inliers, and both poses, each by least
///    squares (refine_pose()) over its own corners, must agree. Walls that look alike, and views of
///    one plane from afar, pass one way now and then, but hardly both.
/// Nothing if any of it fails: then it is not known whether they show the same.
///
/// The measured pose is that of b by a's corners. Its covariance counts what neighbouring corners
/// share, and the calibration (shared_errors.h, calibration_error.h), and is scaled by the
/// residuals and by what both ways differ in where these are larger than claimed. Deterministic; no
/// state. Source of the test both ways: Carlevaris-Bianco and Eustice, 2014; of the search from a
/// first pose: ORB-SLAM (Mur-Artal et al. 2015).
std::optional<ViewAlignment> align_views(const StereoCamera& camera, const StereoView& a,
                                         const StereoView& b, const ViewPrior& prior = {},
                                         const ViewAlignmentOptions& options = {});

}  // namespace prospect
