// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/frame_location.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "engine/support/stopwatch.h"
#include "perception/odometry/image_grid.h"
#include "perception/odometry/image_shift.h"
#include "perception/odometry/median.h"
#include "perception/odometry/track_passes.h"

namespace prospect {
namespace {

/// Least landmarks that make a motion of their own, and how many times as many the world's may be.
constexpr std::size_t kLeastSecond = 12, kSecondShare = 10;
/// Parts of the image's width, to count what of it a motion covers.
constexpr double kParts = 8.0;
constexpr int kAround = 2;  ///< [px of the coarsest level] that a missing landmark stands for

}  // namespace

using Eigen::Isometry3d;
using Eigen::Vector3d;

FrameLocation FrameLocator::locate(std::vector<Track>& tracks, const Isometry3d& prior,
                                   bool trust_prior, const MotionExpectation& expected,
                                   int level) const {
  Stopwatch watch;
  FrameLocation result;
  for (Track& t : tracks) t.tracked = t.inlier = t.has_right = false;
  const Vector3d sigma(options_.sigma_corner, options_.sigma_corner, options_.sigma_disparity);
  TrackObservations observed;
  PoseEstimate coarse;
  PoseEstimatorOptions by_coarse = options_.pose;
  by_coarse.sigma_left = 2.0 * options_.pose.sigma_left + 0.3;  // pixels of level 1, and its blur
  by_coarse.sigma_left *= 1 << level;
  const int deep = options_.pyramid_levels - 1, bottom = level + 1;
  for (int top : {trust_prior ? std::min(bottom + 1, deep) : deep, deep}) {
    track_coarse(tracks, prior, expected.moving_T_CW, left_, {top, bottom}, camera_, options_);
    const auto in_view = std::count_if(tracks.begin(), tracks.end(),
                                       [](const Track& t) { return t.in_view && !t.moving; });
    times_.tracking += watch.lap();
    observed = observe_tracks(tracks, sigma, offset_);
    coarse = ransac_pose(camera_, observed.seen, prior, seed_, by_coarse);
    times_.pose += watch.lap();
    if (top == deep || (coarse.solved && 2 * coarse.inliers >= in_view)) break;
  }
  if (!coarse.solved) return result;
  coarse = refine_pose(camera_, observed.seen, coarse.inlier, coarse.T_CW, by_coarse);
  times_.pose += watch.lap();
  if (!coarse.solved) return result;
  // Blurred points agree on anything a pixel of a smaller image apart.
  if (level == 0) result.second = find_second(tracks, observed, by_coarse, expected, coarse);
  times_.pose += watch.lap();
  // From here the predictions are good to about a pixel, and the warps are right.
  track_fine(tracks, coarse.T_CW, {left_, right_, level}, camera_, offset_, options_);
  times_.tracking += watch.lap();
  observed = observe_tracks(tracks, sigma, offset_);
  result.pose = refine_pose(camera_, observed.seen, {}, coarse.T_CW, options_.pose);
  for (std::size_t k = 0; k < observed.index.size(); ++k) {
    tracks[observed.index[k]].inlier = result.pose.solved && result.pose.inlier[k];
  }
  for (const Track& t : tracks) {
    if (t.moving) continue;
    result.expected += t.in_view;
    result.tracked += t.inlier;
    result.confirmed += t.inlier && t.has_right;
  }
  times_.pose += watch.lap();
  return result;
}

std::vector<int> FrameLocator::find_missing(std::vector<Track>& tracks,
                                            const MotionExpectation& expected,
                                            const Isometry3d& T_CW) const {
  if (expected.before == nullptr) return {};
  const TrustedPose& before = *expected.before;
  std::vector<int> missing;
  std::vector<double> flow;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Track& t = tracks[i];
    if (t.moving || !t.in_view) continue;
    const std::optional<double> moved = image_flow(camera_, t.position, before.T_CW, T_CW);
    if (!moved) continue;
    if (t.tracked) {
      flow.push_back(*moved);
    } else {
      missing.push_back(static_cast<int>(i));
    }
  }
  if (missing.size() < kLeastSecond || flow.empty() || median(flow) > kRestingFlow) return {};
  const PyramidLevel& now = left_.level(left_.levels() - 1);
  const double scale = camera_.left.width / now.width;
  std::vector<char> part(static_cast<std::size_t>(now.width) * now.height, 0);
  for (const int i : missing) {
    const Eigen::Vector2d p =
        camera_.left.project(before.T_CW * tracks[static_cast<std::size_t>(i)].position) / scale;
    for (int dv = -kAround; dv <= kAround; ++dv) {
      for (int du = -kAround; du <= kAround; ++du) {
        const int u = static_cast<int>(p.x()) + du, v = static_cast<int>(p.y()) + dv;
        if (u >= 0 && v >= 0 && u < now.width && v < now.height) {
          part[static_cast<std::size_t>(v) * now.width + u] = 1;
        }
      }
    }
  }
  const Isometry3d prior = turned_by_shift(before.T_CW, before.coarse, now, camera_.left, part);
  std::vector<Track> again;
  for (const int i : missing) again.push_back(tracks[static_cast<std::size_t>(i)]);
  track_coarse(again, prior, {}, left_, {options_.pyramid_levels - 1, 1}, camera_, options_);
  std::vector<int> found;
  for (std::size_t k = 0; k < again.size(); ++k) {
    if (!again[k].tracked) continue;
    tracks[static_cast<std::size_t>(missing[k])] = std::move(again[k]);
    found.push_back(missing[k]);
  }
  return found;
}

std::optional<FrameLocation::Second> FrameLocator::find_second(
    std::vector<Track>& tracks, const TrackObservations& observed,
    const PoseEstimatorOptions& estimation, const MotionExpectation& expected,
    PoseEstimate& world) const {
  const auto hypothesis = [&](const TrackObservations& of, const PoseEstimate& pose) {
    MotionHypothesis h;
    h.T_CW = pose.T_CW;
    std::vector<double> depths;
    const ImageGrid parts(camera_.left.width, camera_.left.height, camera_.left.width / kParts);
    std::vector<char> covered(parts.cells(), 0);
    for (std::size_t k = 0; k < of.index.size(); ++k) {
      if (!pose.inlier[k]) continue;
      h.members.push_back(static_cast<std::size_t>(of.index[k]));
      depths.push_back((pose.T_CW * tracks[h.members.back()].position).z());
      covered[parts.cell(tracks[h.members.back()].left)] = 1;
    }
    h.cells = static_cast<int>(std::count(covered.begin(), covered.end(), 1));
    if (!depths.empty()) h.depth = median(depths);
    return h;
  };
  std::vector<int> rest;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].tracked && tracks[i].moving) rest.push_back(static_cast<int>(i));
  }
  const bool known = !rest.empty();
  for (std::size_t k = 0; k < observed.index.size(); ++k) {
    if (!world.inlier[k]) rest.push_back(observed.index[k]);
  }
  const auto enough = [&](std::size_t n) {
    return n >= kLeastSecond && kSecondShare * n >= static_cast<std::size_t>(world.inliers);
  };
  if (!known && !enough(rest.size())) rest = find_missing(tracks, expected, world.T_CW);
  if (!enough(rest.size())) return std::nullopt;
  const Vector3d sigma(options_.sigma_corner, options_.sigma_corner, options_.sigma_disparity);
  const TrackObservations others = observe_tracks(tracks, std::move(rest), sigma, offset_);
  PoseEstimate other = ransac_pose(camera_, others.seen,
                                   expected.moving_T_CW.value_or(expected.T_CW), seed_, estimation);
  if (!other.solved) return std::nullopt;
  other = refine_pose(camera_, others.seen, other.inlier, other.T_CW, estimation);
  if (!other.solved || !enough(static_cast<std::size_t>(other.inliers))) return std::nullopt;
  MotionHypothesis a = hypothesis(observed, world), b = hypothesis(others, other);
  double log_odds = world_log_odds(a, b, expected);
  // What was found to move before is not the world for being seen better now.
  if (log_odds < 0.0 && !known) {
    world = other;
    std::swap(a, b);
    log_odds = -log_odds;
  }
  for (const std::size_t i : b.members) tracks[i].moving = true;
  return FrameLocation::Second{b.T_CW, log_odds};
}

Isometry3d turned_by_shift(const Isometry3d& T_CW, const PyramidLevel& before,
                           const PyramidLevel& now, const PinholeCamera& camera,
                           const std::vector<char>& part) {
  const std::optional<Eigen::Vector2d> shift = image_shift(before, now, 0.4, part);
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
