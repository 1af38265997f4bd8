// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "perception/odometry/image_pyramid.h"

namespace prospect {

class Knobs;

struct PatchTrackerOptions {
  double min_texture = 0.1;      ///< [grey^2/px^2], see Patch::make
  double min_agreement = 0.5;    ///< of the final alignment, see Patch::Alignment
  double max_return = 0.5;       ///< [px] distance of the backward track from where it began
  double shift_per_level = 6.0;  ///< [px of a level] that alignment may move on it
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, PatchTrackerOptions& options);

enum class TrackOutcome { kTracked, kNotInView, kNoTexture, kNotFound, kNotConsistent };

struct TrackResult {
  TrackOutcome outcome = TrackOutcome::kNotFound;
  Eigen::Vector2f position = Eigen::Vector2f::Zero();  ///< [px], if tracked
  float agreement = 0.0f;
  /// [px^2] of the position, see Patch::Alignment; if tracked.
  Eigen::Matrix2f covariance = Eigen::Matrix2f::Zero();
};

/// How a patch is expected to look in another image: where [px], and A: offsets there times A are
/// offsets in the patch's own image. A known change of scale and rotation is so taken out of the
/// patch before it is compared, which keeps tracks exact when the camera approaches.
struct PatchStart {
  Eigen::Vector2f position;
  Eigen::Matrix2f A;
};

/// Of a pyramid, from coarse to fine.
struct LevelRange {
  int top = 0, bottom = 0;
};

/// Finds the patch around `point` of one image in another, from `start`, coarse to fine (pyramidal
/// alignment: Bouguet 2000), on the levels from `top` to `bottom`.
///
/// Levels on which the patch leaves the image or has no texture are skipped; `bottom` is not. With
/// `check_return` the patch found is tracked back on that level and must return to `point`.
/// Deterministic; no state.
TrackResult track_patch(const ImagePyramid& from, const Eigen::Vector2f& point,
                        const ImagePyramid& to, const PatchStart& start, LevelRange levels,
                        bool check_return, const PatchTrackerOptions& options = {});

struct StereoTrackResult {
  TrackResult left;
  bool in_right = false;  ///< found in the right image, too
  Eigen::Vector2f right = Eigen::Vector2f::Zero();
  Eigen::Matrix2f right_covariance = Eigen::Matrix2f::Zero();
};

/// The same in both images of a pair, from starts that are good to a few pixels: level 0 only, with
/// a warp for each, as a slanted surface looks otherwise to either camera, and with the check of
/// return in the left image. The right image is searched only if the left one shows the patch.
StereoTrackResult track_stereo_patch(const ImagePyramid& from, const Eigen::Vector2f& point,
                                     const ImagePyramid& left, const PatchStart& start_left,
                                     const ImagePyramid& right, const PatchStart& start_right,
                                     const PatchTrackerOptions& options = {});

}  // namespace prospect
