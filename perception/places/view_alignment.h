// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "models/camera.h"
#include "perception/odometry/relative_pose.h"
#include "perception/places/stereo_view.h"

namespace prospect {

struct ViewAlignmentOptions {
  int most_bits = 64;         ///< by which descriptors of one point differ
  double distinctness = 0.9;  ///< the nearest descriptor over the next one, at most
  int least_inliers = 20;
  double most_apart = 0.3;    ///< [m], of both ways
  double most_turned = 0.09;  ///< [rad], of both ways
  double sigma = 0.7;         ///< of a corner's place [pixels of its level]
};

struct ViewAlignment {
  RelativePose measured;  ///< camera b in camera a
  int inliers = 0;        ///< of the way that has fewer
};

/// Whether two views show the same, and from where.
///
/// 1. Corners are paired whose descriptors are each other's nearest, and clearly nearer than the
///    next.
/// 2. Two poses are found, each by RANSAC: of b from where a has the corners in space and b sees
///    them, and of a likewise (P3P). Each needs least_inliers, and both must agree. Walls that look
///    alike, and views of one plane from afar, pass one way now and then, but hardly both.
/// 3. b in a by least squares over both stereo measurements (refine_pose()).
/// Nothing if any of it fails: then it is not known whether they show the same.
///
/// The information counts corners as independent, their places with `sigma`. Deterministic; no
/// state. Source of the test both ways: Carlevaris-Bianco and Eustice, 2014; ours else.
std::optional<ViewAlignment> align_views(const StereoCamera& camera, const StereoView& a,
                                         const StereoView& b,
                                         const ViewAlignmentOptions& options = {});

}  // namespace prospect
