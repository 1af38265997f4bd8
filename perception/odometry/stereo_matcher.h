// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "perception/odometry/image_pyramid.h"

namespace prospect {

class Knobs;

struct StereoMatcherOptions {
  double max_disparity = 0.25;  ///< searched range, as a share of the image's width
  double min_disparity = 1.0;   ///< [px]; a farther point says nothing about depth
  double min_correlation = 0.8;
  /// Another peak of the correlation c, more than 2 px away, must have 1 - c at least this many
  /// times that of the best: repeated texture does not tell.
  double distinctness = 1.4;
  double max_row_error = 1.5;      ///< [px]
  double max_inconsistency = 0.5;  ///< [px] left to right and back
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, StereoMatcherOptions& options);

struct StereoMatch {
  int index = 0;           ///< of the point that was asked for
  double disparity = 0.0;  ///< d = u_left - u_right [px]
  /// v_right - v_left [px]: zero but for noise where the pair is rectified.
  double row_error = 0.0;
  double variance = 0.0;  ///< of the disparity [px^2], at this slope; see Patch::Alignment
  Eigen::Vector2f slope = Eigen::Vector2f::Zero();  ///< of the disparity [px/px], see SlantedPatch
};

/// Sub-pixel correspondences, in the right image of a rectified pair, of points of the left one.
///
/// 1. Zero-mean normalised cross-correlation of 11 x 11 patches along the row, over all
/// disparities;
///    the best must be good enough and distinct, and searching back from it must come back.
/// 2. Alignment of the 15 x 15 patch in both coordinates, first as if it faced the cameras
///    (patch_alignment.h), then with its slope (patch_slope.h), and once more with that slope held;
///    the row error is the vertical part. Then the last from right to left, which must return to
///    the point.
/// Points without a match are left out; order as given. Deterministic; no state.
std::vector<StereoMatch> match_stereo(const ImagePyramid& left, const ImagePyramid& right,
                                      const std::vector<Eigen::Vector2f>& points,
                                      const StereoMatcherOptions& options = {});

}  // namespace prospect
