// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/landmark_builder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "adapters/robots/simulator/depth_camera.h"
#include "models/knobs.h"

namespace prospect {
namespace {}  // namespace

LandmarkBuilder::LandmarkBuilder(const LandmarkBuilderOptions& options,
                                 const FeatureCameraOptions& camera, const CameraMount& mount)
    : options_(options),
      camera_(camera),
      mount_(mount),
      map_(std::make_shared<LandmarkMap>()),
      density_(options.density) {
  check_knobs("landmark builder", options);
  map_->feature_density = density_.value();
}

void LandmarkBuilder::forget() {
  map_ = std::make_shared<LandmarkMap>();
  map_->feature_density = density_.value();
  statistics_.clear();
  position_.clear();
}

void LandmarkBuilder::update(const std::vector<FeatureObservation>& observations,
                             const Pose& estimated_pose, const VoxelGrid& voxels,
                             double surface_area, int anchor) {
  if (map_.use_count() != 1) map_ = std::make_shared<LandmarkMap>(*map_);
  ++keyframe_;
  int new_landmarks = 0;
  const StereoCamera& stereo = camera_.stereo;
  const Eigen::Isometry3d T_WC = camera_pose(estimated_pose, mount_);
  const Eigen::Isometry3d T_CW = T_WC.inverse();
  const Eigen::Vector3d eye = T_WC.translation();
  std::vector<Landmark>& landmarks = map_->landmarks;
  const double cos_change = std::cos(std::min(options_.max_view_change, 3.14));

  const auto within_creation_view = [&](const Landmark& landmark, const Eigen::Vector3d& to_eye) {
    const double range = to_eye.norm();
    return range > 0.0 && range <= options_.max_scale * landmark.creation_range &&
           landmark.creation_range <= options_.max_scale * range &&
           to_eye.dot(landmark.creation_direction) >= cos_change * range;
  };

  // What was expected in this view, before it changes the map.
  const double reach = 2.0 * camera_.max_depth;
  const double trim = 1.5 * voxels.resolution();
  for (std::size_t n = 0; n < landmarks.size(); ++n) {
    const Landmark& landmark = landmarks[n];
    const Eigen::Vector3d to_eye = eye - landmark.position;
    if (to_eye.squaredNorm() > reach * reach) continue;
    const Eigen::Vector3d Y = T_CW * landmark.position;
    if (!(Y.z() >= camera_.min_depth && Y.z() <= camera_.max_depth)) continue;
    const double u = stereo.left.cx + stereo.left.fx * Y.x() / Y.z();
    const double v = stereo.left.cy + stereo.left.fy * Y.y() / Y.z();
    const double right = u - stereo.left.fx * stereo.baseline / Y.z();
    if (!(right >= 0.0 && u <= stereo.left.width && v >= 0.0 && v <= stereo.left.height)) continue;
    if (!within_creation_view(landmark, to_eye)) continue;
    if (voxels.cast(eye, landmark.position, trim).blocked) continue;
    ++statistics_[n].expected;
    statistics_[n].last_seen |= std::uint64_t{1} << 63;  // expected now
  }
  constexpr std::uint64_t kExpected = std::uint64_t{1} << 63;

  for (const FeatureObservation& o : observations) {
    if (!(o.disparity > 0.0)) continue;
    const std::uint64_t id = o.feature;
    const auto [it, fresh] =
        position_.try_emplace(id, static_cast<std::uint32_t>(landmarks.size()));
    if (fresh) {
      landmarks.emplace_back();
      landmarks.back().id = id;
      statistics_.emplace_back();
      ++new_landmarks;
    }
    Landmark& landmark = landmarks[it->second];
    Statistics& s = statistics_[it->second];
    ++s.tracked;
    if ((s.last_seen & kExpected) == 0) ++s.expected;  // seen against expectation
    s.last_seen = keyframe_;

    const Eigen::Vector3d Y = stereo.triangulate(o.u, o.v, o.disparity);
    const Eigen::Vector3d position = T_WC * Y;
    const Eigen::Matrix3d R = T_WC.linear();
    const Eigen::Matrix3d covariance =
        R * stereo.triangulation_covariance(o.u, o.v, o.disparity) * R.transpose();
    const bool anew = fresh || !within_creation_view(landmark, eye - landmark.position);
    if (anew || covariance.trace() < 0.5 * landmark.covariance.trace()) {
      landmark.position = position;
      landmark.covariance = covariance;
      s.anchor = anchor;
    }
    if (anew) {
      const Eigen::Vector3d to_eye = eye - position;
      landmark.creation_range = to_eye.norm();
      landmark.creation_direction = to_eye / landmark.creation_range;
    }
  }

  for (std::size_t n = 0; n < landmarks.size(); ++n) {
    Statistics& s = statistics_[n];
    s.last_seen &= ~kExpected;
    landmarks[n].survival =
        (options_.survival_prior_tracked + s.tracked) /
        (options_.survival_prior_tracked + options_.survival_prior_missed + s.expected);
  }

  density_.add(new_landmarks, surface_area);
  map_->feature_density = density_.value();
  cull();
}

void LandmarkBuilder::follow(const std::vector<PlanarMove>& anchors) {
  if (map_.use_count() > 1) map_ = std::make_shared<LandmarkMap>(*map_);
  for (std::size_t n = 0; n < map_->landmarks.size(); ++n) {
    const auto anchor = static_cast<std::size_t>(statistics_[n].anchor);
    if (anchor >= anchors.size()) continue;
    const PlanarMove& move = anchors[anchor];
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(move.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    Landmark& landmark = map_->landmarks[n];
    landmark.position = move(landmark.position);
    landmark.covariance = R * landmark.covariance * R.transpose();
    landmark.creation_direction = R * landmark.creation_direction;
  }
}

void LandmarkBuilder::cull() {
  std::vector<Landmark>& landmarks = map_->landmarks;
  const std::size_t n = landmarks.size();
  std::vector<bool> drop(n, false);
  std::size_t dropped = 0;
  for (std::size_t a = 0; a < n; ++a) {
    if (landmarks[a].survival < options_.cull_survival &&
        statistics_[a].expected >= options_.cull_views) {
      drop[a] = true;
      ++dropped;
    }
  }
  const auto limit = static_cast<std::size_t>(options_.max_landmarks);
  if (n - dropped > limit) {
    // A tenth more than needed, so that the sort is rare.
    const std::size_t keep = limit - limit / 10;
    std::vector<std::size_t> order;
    for (std::size_t a = 0; a < n; ++a) {
      if (!drop[a]) order.push_back(a);
    }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const bool now_a = statistics_[a].last_seen == keyframe_;
      const bool now_b = statistics_[b].last_seen == keyframe_;
      if (now_a != now_b) return now_b;
      if (landmarks[a].survival != landmarks[b].survival) {
        return landmarks[a].survival < landmarks[b].survival;
      }
      if (statistics_[a].last_seen != statistics_[b].last_seen) {
        return statistics_[a].last_seen < statistics_[b].last_seen;
      }
      return landmarks[a].id < landmarks[b].id;
    });
    for (std::size_t a = 0; a + keep < order.size(); ++a) drop[order[a]] = true;
    dropped = 1;
  }
  if (dropped == 0) return;
  std::size_t to = 0;
  for (std::size_t a = 0; a < n; ++a) {
    if (drop[a]) {
      position_.erase(landmarks[a].id);
      continue;
    }
    if (to != a) {
      landmarks[to] = landmarks[a];
      statistics_[to] = statistics_[a];
    }
    position_[landmarks[to].id] = static_cast<std::uint32_t>(to);
    ++to;
  }
  landmarks.resize(to);
  statistics_.resize(to);
}

}  // namespace prospect
