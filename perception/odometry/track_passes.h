// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/patch_tracker.h"
#include "perception/odometry/stereo_odometry_options.h"
#include "perception/odometry/track.h"

namespace prospect {

/// The two passes in which the landmarks are looked for in a new frame, from where they are
/// predicted at the pose T_CW. Both forget what the last pass found, and set in_view, tracked and
/// left of every track. Deterministic; no state.
///
/// First pass: the left image only, from the top of these levels of the pyramid down to the bottom.
/// Some of what it finds is wrong. Those that move are predicted at `moving_T_CW` instead; none: at
/// T_CW, too.
void track_coarse(std::vector<Track>& tracks, const Eigen::Isometry3d& T_CW,
                  const std::optional<Eigen::Isometry3d>& moving_T_CW, const ImagePyramid& left,
                  LevelRange levels, const StereoCamera& camera,
                  const StereoOdometryOptions& options);

/// The images of a pair, and the level of their pyramids that is looked at.
struct PairLevel {
  const ImagePyramid& left;
  const ImagePyramid& right;
  int level = 0;
};

/// Second pass: both images on one level, from a pose that is good to about a pixel of it, without
/// those that move. Sets right,
/// has_right, in_right and row_error, too. `offset`: correction of the disparity's zero [px].
void track_fine(std::vector<Track>& tracks, const Eigen::Isometry3d& T_CW, const PairLevel& pair,
                const StereoCamera& camera, double offset, const StereoOdometryOptions& options);

/// Those that the left image shows, at the pose T_CW, but the right one not near their rows: looks
/// for them in any row, from the top of the pyramid on. Sets in_right and row_error alone, for
/// camera_time_offset.h; the pose has nothing of them.
void track_rows(std::vector<Track>& tracks, const Eigen::Isometry3d& T_CW,
                const ImagePyramid& right, const StereoCamera& camera, double offset,
                const StereoOdometryOptions& options);

}  // namespace prospect
