// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/frame_location.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "engine/support/stopwatch.h"
#include "perception/odometry/image_shift.h"
#include "perception/odometry/track_passes.h"

namespace prospect {

using Eigen::Isometry3d;
using Eigen::Vector3d;

FrameLocation FrameLocator::locate(std::vector<Track>& tracks, const Isometry3d& prior,
                                   bool trust_prior) const {
  Stopwatch watch;
  FrameLocation result;
  for (Track& t : tracks) t.tracked = t.inlier = t.has_right = false;
  const Vector3d sigma(options_.sigma_corner, options_.sigma_corner, options_.sigma_disparity);
  TrackObservations observed;
  PoseEstimate coarse;
  PoseEstimatorOptions level_1 = options_.pose;
  level_1.sigma_left = 2.0 * options_.pose.sigma_left + 0.3;  // pixels of that level, and its blur
  const int deep = options_.pyramid_levels - 1;
  for (int top : {trust_prior ? std::min(2, deep) : deep, deep}) {
    track_coarse(tracks, prior, left_, top, camera_, options_);
    const auto in_view =
        std::count_if(tracks.begin(), tracks.end(), [](const Track& t) { return t.in_view; });
    times_.tracking += watch.lap();
    observed = observe_tracks(tracks, sigma, offset_);
    coarse = ransac_pose(camera_, observed.seen, prior, seed_, level_1);
    times_.pose += watch.lap();
    if (top == deep || (coarse.solved && 2 * coarse.inliers >= in_view)) break;
  }
  if (!coarse.solved) return result;
  coarse = refine_pose(camera_, observed.seen, coarse.inlier, coarse.T_CW, level_1);
  times_.pose += watch.lap();
  if (!coarse.solved) return result;
  // From here the predictions are good to about a pixel, and the warps are right.
  track_fine(tracks, coarse.T_CW, left_, right_, camera_, offset_, options_);
  times_.tracking += watch.lap();
  observed = observe_tracks(tracks, sigma, offset_);
  result.pose = refine_pose(camera_, observed.seen, {}, coarse.T_CW, options_.pose);
  for (std::size_t k = 0; k < observed.index.size(); ++k) {
    tracks[observed.index[k]].inlier = result.pose.solved && result.pose.inlier[k];
  }
  for (const Track& t : tracks) {
    result.expected += t.in_view;
    result.tracked += t.inlier;
    result.confirmed += t.inlier && t.has_right;
  }
  times_.pose += watch.lap();
  return result;
}

Isometry3d turned_by_shift(const Isometry3d& T_CW, const PyramidLevel& before,
                           const PyramidLevel& now, const PinholeCamera& camera) {
  const std::optional<Eigen::Vector2d> shift = image_shift(before, now);
  if (!shift) return T_CW;
  const double scale = camera.width / now.width;
  const double yaw = std::atan(scale * shift->x() / camera.fx);
  const double pitch = std::atan(scale * shift->y() / camera.fy);
  Isometry3d R = Isometry3d::Identity();
  R.linear() =
      (Eigen::AngleAxisd(yaw, Vector3d::UnitY()) * Eigen::AngleAxisd(-pitch, Vector3d::UnitX()))
          .toRotationMatrix();
  return R * T_CW;
}

}  // namespace prospect
