// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/track_passes.h"

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "perception/odometry/patch_tracker.h"

namespace prospect {
namespace {

std::optional<TrackPrediction> begin_tracking(Track& t, const Eigen::Isometry3d& T_CW,
                                              const StereoCamera& camera, double max_scale) {
  const auto predicted = predict_track(t, T_CW, camera, max_scale);
  t.tracked = t.has_right = t.in_right = false;
  t.in_view = predicted.has_value();
  return predicted;
}

/// In both images, on one level.
StereoTrackResult track_pair(const Track& t, const PairLevel& pair, const PatchStart& left,
                             const PatchStart& right, const PatchTrackerOptions& options) {
  if (pair.level == 0) {
    return track_stereo_patch(t.anchor->left, t.pixel, pair.left, left, pair.right, right, options);
  }
  const LevelRange only{pair.level, pair.level};
  StereoTrackResult result;
  result.left = track_patch(t.anchor->left, t.pixel, pair.left, left, only, true, options);
  if (result.left.outcome != TrackOutcome::kTracked) return result;
  const Eigen::Vector2f start = right.position + result.left.position - left.position;
  const TrackResult other =
      track_patch(t.anchor->left, t.pixel, pair.right, {start, right.A}, only, false, options);
  result.in_right = other.outcome == TrackOutcome::kTracked;
  result.right = other.position;
  result.right_covariance = other.covariance;
  return result;
}

}  // namespace

void track_coarse(std::vector<Track>& tracks, const Eigen::Isometry3d& T_CW,
                  const std::optional<Eigen::Isometry3d>& moving_T_CW, const ImagePyramid& left,
                  LevelRange levels, const StereoCamera& camera,
                  const StereoOdometryOptions& options) {
  for (Track& t : tracks) {
    const auto start =
        begin_tracking(t, t.moving ? moving_T_CW.value_or(T_CW) : T_CW, camera, options.max_scale);
    if (!start) continue;
    const TrackResult result = track_patch(t.anchor->left, t.pixel, left, {start->pixel, start->A},
                                           levels, false, options.tracking);
    t.tracked = result.outcome == TrackOutcome::kTracked;
    if (!t.tracked) continue;
    t.left = result.position;
    t.left_covariance = options.texture_noise * result.covariance.cast<double>();
  }
}

void track_fine(std::vector<Track>& tracks, const Eigen::Isometry3d& T_CW, const PairLevel& pair,
                const StereoCamera& camera, double offset, const StereoOdometryOptions& options) {
  // What all positions have in common is so many pixels of the level.
  const double scale = 1 << pair.level, coarser = scale * scale - 1.0;
  for (Track& t : tracks) {
    if (t.moving) continue;
    const auto start = begin_tracking(t, T_CW, camera, options.max_scale);
    if (!start) continue;
    const double depth = (T_CW * t.position).z();
    const float disparity = static_cast<float>(camera.left.fx * camera.baseline / depth - offset);
    const StereoTrackResult result = track_pair(
        t, pair, {start->pixel, start->A},
        {start->pixel - Eigen::Vector2f(disparity, 0.0f), start->A_right}, options.tracking);
    t.tracked = result.left.outcome == TrackOutcome::kTracked;
    if (!t.tracked) continue;
    t.left = result.left.position;
    t.left_covariance = options.texture_noise * result.left.covariance.cast<double>();
    t.left_covariance.diagonal().array() += coarser * std::pow(options.pose.sigma_left, 2);
    t.right = result.right.x();
    t.right_variance = options.texture_noise * result.right_covariance(0, 0) +
                       coarser * std::pow(options.pose.sigma_right, 2);
    t.in_right = result.in_right;
    t.row_error = result.right.y() - t.left.y();
    t.has_right = t.in_right && std::abs(t.row_error) <= scale * options.matching.max_row_error;
  }
}

void track_rows(std::vector<Track>& tracks, const Eigen::Isometry3d& T_CW,
                const ImagePyramid& right, const StereoCamera& camera, double offset,
                const StereoOdometryOptions& options) {
  for (Track& t : tracks) {
    if (!t.inlier || t.in_right) continue;
    const auto start = predict_track(t, T_CW, camera, options.max_scale);
    if (!start) continue;
    const double depth = (T_CW * t.position).z();
    const float disparity = static_cast<float>(camera.left.fx * camera.baseline / depth - offset);
    const TrackResult result = track_patch(
        t.anchor->left, t.pixel, right, {t.left - Eigen::Vector2f(disparity, 0.0f), start->A_right},
        {right.levels() - 1, 0}, true, options.tracking);
    if (result.outcome != TrackOutcome::kTracked) continue;
    t.in_right = true;
    t.row_error = result.position.y() - t.left.y();
  }
}

}  // namespace prospect
