// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/patch_tracker.h"

#include <Eigen/LU>
#include <algorithm>

#include "perception/odometry/patch_alignment.h"

namespace prospect {
namespace {

/// Whether the patch that `to` shows at `position` is found again at `point` of `from`.
bool returns(const PyramidLevel& from, const Eigen::Vector2f& point, const Eigen::Matrix2f& A,
             const PyramidLevel& to, const Eigen::Vector2f& position,
             const PatchTrackerOptions& options) {
  const auto patch =
      Patch::make(to, position, A.inverse(), static_cast<float>(options.min_texture));
  if (!patch) return false;
  const Patch::Alignment back = patch->align(from, point, 2.0f);
  return back.converged && (back.position - point).norm() <= options.max_return;
}

bool inside(const PyramidLevel& image, const Eigen::Vector2f& p) {
  return p.x() >= 0 && p.x() <= image.width - 1 && p.y() >= 0 && p.y() <= image.height - 1;
}

}  // namespace

TrackResult track_patch(const ImagePyramid& from, const Eigen::Vector2f& point,
                        const ImagePyramid& to, const PatchStart& start, LevelRange levels,
                        bool check_return, const PatchTrackerOptions& options) {
  TrackResult result;
  Eigen::Vector2f position = start.position;
  if (!inside(to.level(0), position)) {
    result.outcome = TrackOutcome::kNotInView;
    return result;
  }
  const int lowest = std::min({levels.bottom, from.levels() - 1, to.levels() - 1});
  float scale = 1.0f;
  for (int l = std::min({levels.top, from.levels() - 1, to.levels() - 1}); l >= lowest; --l) {
    const bool last = l == lowest;
    scale = 1.0f / static_cast<float>(1 << l);
    const auto patch =
        Patch::make(from.level(l), scale * point, start.A, static_cast<float>(options.min_texture));
    if (!patch) {
      if (!last) continue;
      result.outcome = TrackOutcome::kNoTexture;
      return result;
    }
    const Patch::Alignment found =
        patch->align(to.level(l), scale * position, static_cast<float>(options.shift_per_level),
                     last ? 20 : 10, last ? 0.01f : 0.05f);
    if (found.converged) position = found.position / scale;
    if (!last) continue;
    if (!found.converged || found.agreement < options.min_agreement) return result;
    result.agreement = found.agreement;
    result.covariance = found.covariance / (scale * scale);
  }
  if (check_return && !returns(from.level(lowest), scale * point, start.A, to.level(lowest),
                               scale * position, options)) {
    result.outcome = TrackOutcome::kNotConsistent;
    return result;
  }
  result.outcome = TrackOutcome::kTracked;
  result.position = position;
  return result;
}

StereoTrackResult track_stereo_patch(const ImagePyramid& from, const Eigen::Vector2f& point,
                                     const ImagePyramid& left, const PatchStart& start_left,
                                     const ImagePyramid& right, const PatchStart& start_right,
                                     const PatchTrackerOptions& options) {
  StereoTrackResult result;
  if (!inside(left.level(0), start_left.position)) {
    result.left.outcome = TrackOutcome::kNotInView;
    return result;
  }
  const float texture = static_cast<float>(options.min_texture);
  const auto patch = Patch::make(from.level(0), point, start_left.A, texture);
  if (!patch) {
    result.left.outcome = TrackOutcome::kNoTexture;
    return result;
  }
  const Patch::Alignment found =
      patch->align(left.level(0), start_left.position, static_cast<float>(options.shift_per_level));
  if (!found.converged || found.agreement < options.min_agreement) return result;
  if (!returns(from.level(0), point, start_left.A, left.level(0), found.position, options)) {
    result.left.outcome = TrackOutcome::kNotConsistent;
    return result;
  }
  result.left = {TrackOutcome::kTracked, found.position, found.agreement, found.covariance};
  // What moved the left track from its start moves the right one, too.
  const Eigen::Vector2f start = start_right.position + found.position - start_left.position;
  if (!inside(right.level(0), start)) return result;
  const auto right_patch = Patch::make(from.level(0), point, start_right.A, texture);
  if (!right_patch) return result;
  const Patch::Alignment other =
      right_patch->align(right.level(0), start, static_cast<float>(options.shift_per_level));
  result.in_right = other.converged && other.agreement >= options.min_agreement;
  result.right = other.position;
  result.right_covariance = other.covariance;
  return result;
}

}  // namespace prospect
