// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "perception/odometry/frame_location.h"
#include "perception/odometry/image_grid.h"
#include "perception/odometry/keyframe_policy.h"
#include "perception/odometry/track.h"

namespace prospect {

/// The newest keyframe: what later frames are held against.
struct Keyframe {
  std::uint64_t anchor = 0;  ///< of the landmarks that are made at it
  Eigen::Isometry3d T_CW = Eigen::Isometry3d::Identity();
  KeyframeView best;  ///< of the frames since, as in KeyframeEvidence

  /// Marks the track with what the keyframe's image shows of it.
  static void see(Track& track);

  /// What speaks for another keyframe, at a frame that was located by these tracks; enters what it
  /// sees. `coarse`: cells of twice the side of those that hold a corner each; `width` of the image
  /// [px].
  KeyframeEvidence evidence(const FrameLocation& location, const std::vector<Track>& tracks,
                            const ImageGrid& coarse, double width);
};

}  // namespace prospect
