// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "engine/maps/localization.h"
#include "models/camera.h"
#include "perception/odometry/frame_location.h"
#include "perception/odometry/stereo_odometry_options.h"
#include "perception/odometry/track.h"
#include "perception/odometry/trusted_pose.h"

namespace prospect {

/// Whether a pose is to be taken, and why not.
struct PoseJudgement {
  Localization state = Localization::kOk;
  std::string reason;  ///< several are joined by "; "; empty if ok
};

/// Judges where a frame at `now` [s] was located by `tracks`. Lost: too few points, too few of
/// those in view, a right image that does not fit, a pose that they do not fix, or a motion from
/// the last trusted pose that cannot be. Degraded: fewer points than usual, or a half of either
/// image on which nothing is found. Deterministic; no state.
PoseJudgement judge_pose(const FrameLocation& location, const std::vector<Track>& tracks,
                         const TrustedPose& last, double now, const PinholeCamera& camera,
                         const StereoOdometryOptions& options);

}  // namespace prospect
