// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/feature_camera.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "adapters/robots/simulator/depth_camera.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
FeatureCamera::FeatureCamera(const World& world, const FeatureField& field,
                             const FeatureCameraOptions& options, const CameraMount& mount,
                             std::uint64_t seed)
    : world_(&world), field_(&field), options_(options), mount_(mount), noise_(seed) {
  const StereoCamera& s = options.stereo;
  validate(s);
  check_knobs("feature camera", options);
  check_parameter(2.0 * options.border < std::min(s.left.width, s.left.height), "feature camera",
                  "border", options.border, "less than half the image");
}

double FeatureCamera::pixels(double cosine, double depth) const {
  return options_.size * options_.stereo.left.fx * cosine / depth;
}

std::vector<std::uint32_t> FeatureCamera::visible(const Pose& true_pose) const {
  const PinholeCamera& camera = options_.stereo.left;
  const Eigen::Isometry3d T_WC = camera_pose(true_pose, mount_);
  const Eigen::Isometry3d T_CW = T_WC.inverse();
  const Eigen::Vector3d eye = T_WC.translation();
  const double cos_limit = std::cos(options_.max_view_angle);
  // Corners of the image lie farther away than max_depth along the optical axis.
  const double tan_u = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double tan_v = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  const double reach = options_.max_depth * std::sqrt(1.0 + tan_u * tan_u + tan_v * tan_v);

  std::vector<std::uint32_t> result;
  field_->near(eye.x(), eye.y(), reach, [&](std::uint32_t n) {
    const Feature& feature = field_->features()[n];
    const Eigen::Vector3d Y = T_CW * feature.position;
    if (!(Y.z() >= options_.min_depth && Y.z() <= options_.max_depth)) return;
    const double u = camera.cx + camera.fx * Y.x() / Y.z();
    const double v = camera.cy + camera.fy * Y.y() / Y.z();
    const double right = u - camera.fx * options_.stereo.baseline / Y.z();
    const double b = options_.border;
    if (!(right >= b && u <= camera.width - b && v >= b && v <= camera.height - b)) return;
    const Eigen::Vector3d to_eye = eye - feature.position;
    const double cosine = to_eye.dot(feature.normal) / to_eye.norm();
    if (!(cosine >= cos_limit && pixels(cosine, Y.z()) >= options_.min_pixels)) return;
    // A millimetre before the surface, so that the feature's own voxel does not hide it.
    const VoxelGrid::Ray ray = world_->voxels.cast(eye, feature.position + 1e-3 * feature.normal);
    if (ray.blocked || ray.unknown_length > 0.0) return;
    result.push_back(n);
  });
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<FeatureObservation> FeatureCamera::observe(const Pose& true_pose, int* visible_count) {
  const std::vector<std::uint32_t> seen = visible(true_pose);
  if (visible_count != nullptr) *visible_count = static_cast<int>(seen.size());
  const StereoCamera& stereo = options_.stereo;
  const PinholeCamera& camera = stereo.left;
  const Eigen::Isometry3d T_CW = camera_pose(true_pose, mount_).inverse();
  const double cell = std::sqrt(camera.width * camera.height / options_.cells);
  const int columns = static_cast<int>(camera.width / cell) + 1;
  const int rows = static_cast<int>(camera.height / cell) + 1;
  // Where the kept ones are, by cells, at most one in each.
  constexpr double kNowhere = -1e9;
  std::vector<Eigen::Vector2d> occupant(static_cast<std::size_t>(columns * rows),
                                        {kNowhere, kNowhere});
  struct Seen {
    std::uint32_t feature;
    int column, row;
    Eigen::Vector2d pixel;
    double size;
  };
  const auto at = [&](int column, int row) -> Eigen::Vector2d& {
    return occupant[static_cast<std::size_t>(row * columns + column)];
  };
  const auto is_free = [&](const Seen& s, int reach, double distance) {
    for (int j = std::max(0, s.row - reach); j <= std::min(rows - 1, s.row + reach); ++j) {
      for (int i = std::max(0, s.column - reach); i <= std::min(columns - 1, s.column + reach);
           ++i) {
        const bool own = i == s.column && j == s.row;
        if (own ? at(i, j).x() != kNowhere : (at(i, j) - s.pixel).norm() < distance) return false;
      }
    }
    return true;
  };

  std::vector<std::uint32_t> kept;
  std::vector<Seen> fresh;
  const Eigen::Vector3d eye = T_CW.inverse().translation();
  for (const std::uint32_t n : seen) {
    const Feature& feature = field_->features()[n];
    const Eigen::Vector3d Y = T_CW * feature.position;
    const Eigen::Vector2d p = camera.project(Y);
    const double cosine = (eye - feature.position).normalized().dot(feature.normal);
    const Seen s{n, std::clamp(static_cast<int>(p.x() / cell), 0, columns - 1),
                 std::clamp(static_cast<int>(p.y() / cell), 0, rows - 1), p, pixels(cosine, Y.z())};
    if (!std::binary_search(tracked_.begin(), tracked_.end(), n)) {
      fresh.push_back(s);
    } else if (is_free(s, 0, 0.0)) {
      at(s.column, s.row) = s.pixel;
      kept.push_back(n);
    }
  }
  std::stable_sort(fresh.begin(), fresh.end(),
                   [](const Seen& a, const Seen& b) { return a.size > b.size; });
  for (const Seen& s : fresh) {
    if (!is_free(s, 1, 0.5 * cell)) continue;
    at(s.column, s.row) = s.pixel;
    kept.push_back(s.feature);
  }
  std::sort(kept.begin(), kept.end());
  tracked_ = kept;

  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<FeatureObservation> observations;
  observations.reserve(kept.size());
  for (const std::uint32_t n : kept) {
    FeatureObservation o;
    o.feature = n;
    o.true_point = T_CW * field_->features()[n].position;
    const double z = o.true_point.z();
    const double e_u = normal(noise_), e_v = normal(noise_), e_d = normal(noise_);
    o.u = camera.cx + camera.fx * o.true_point.x() / z + stereo.sigma_u * e_u;
    o.v = camera.cy + camera.fy * o.true_point.y() / z + stereo.sigma_v * e_v;
    const double d = camera.fx * stereo.baseline / z;
    // A matcher reports no disparity that would put the point behind the camera or at infinity.
    o.disparity = std::max(d + stereo.sigma_d * e_d, 0.25 * d);
    observations.push_back(o);
  }
  return observations;
}

}  // namespace prospect
