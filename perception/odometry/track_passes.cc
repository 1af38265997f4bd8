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

}  // namespace

void track_coarse(std::vector<Track>& tracks, const Eigen::Isometry3d& T_CW,
                  const std::optional<Eigen::Isometry3d>& moving_T_CW, const ImagePyramid& left,
                  int top, const StereoCamera& camera, const StereoOdometryOptions& options) {
  for (Track& t : tracks) {
    const auto start =
        begin_tracking(t, t.moving ? moving_T_CW.value_or(T_CW) : T_CW, camera, options.max_scale);
    if (!start) continue;
    const TrackResult result = track_patch(t.anchor->left, t.pixel, left, {start->pixel, start->A},
                                           {top, 1}, false, options.tracking);
    t.tracked = result.outcome == TrackOutcome::kTracked;
    if (!t.tracked) continue;
    t.left = result.position;
    t.left_covariance = options.texture_noise * result.covariance.cast<double>();
  }
}

void track_fine(std::vector<Track>& tracks, const Eigen::Isometry3d& T_CW, const ImagePyramid& left,
                const ImagePyramid& right, const StereoCamera& camera, double offset,
                const StereoOdometryOptions& options) {
  for (Track& t : tracks) {
    if (t.moving) continue;
    const auto start = begin_tracking(t, T_CW, camera, options.max_scale);
    if (!start) continue;
    const double depth = (T_CW * t.position).z();
    const float disparity = static_cast<float>(camera.left.fx * camera.baseline / depth - offset);
    const StereoTrackResult result = track_stereo_patch(
        t.anchor->left, t.pixel, left, {start->pixel, start->A}, right,
        {start->pixel - Eigen::Vector2f(disparity, 0.0f), start->A_right}, options.tracking);
    t.tracked = result.left.outcome == TrackOutcome::kTracked;
    if (!t.tracked) continue;
    t.left = result.left.position;
    t.left_covariance = options.texture_noise * result.left.covariance.cast<double>();
    t.right = result.right.x();
    t.right_variance = options.texture_noise * result.right_covariance(0, 0);
    t.in_right = result.in_right;
    t.row_error = result.right.y() - t.left.y();
    t.has_right = t.in_right && std::abs(t.row_error) <= options.matching.max_row_error;
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
