// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/depth_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "adapters/formats/worlds/sloped_floor.h"
#include "models/body_transform.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {

Eigen::Isometry3d camera_pose(const Pose& body, const CameraMount& mount) {
  return body_transform(body) * mount.T_BC;
}

DepthCamera::DepthCamera(const World& world, const DepthCameraOptions& options,
                         const CameraMount& mount, std::uint64_t seed)
    : world_(&world), options_(options), mount_(mount), noise_(seed) {
  const RgbdFootprint& f = options.footprint;
  validate(f);
  check_parameter(std::isfinite(f.max_range) && f.max_range < 1000.0, "depth camera", "max_range",
                  f.max_range, "below 1000 m");
  check_parameter(options.columns >= 1 && options.columns <= 4096, "depth camera", "columns",
                  options.columns, "1..4096");
  check_parameter(options.rows >= 1 && options.rows <= 4096, "depth camera", "rows", options.rows,
                  "1..4096");
  check_knobs("depth camera", options);
  directions_.reserve(static_cast<std::size_t>(options.rows) *
                      static_cast<std::size_t>(options.columns));
  for (int row = 0; row < options.rows; ++row) {
    const double e = f.vertical_fov * (0.5 - (row + 0.5) / options.rows);
    for (int column = 0; column < options.columns; ++column) {
      const double a = f.horizontal_fov * ((column + 0.5) / options.columns - 0.5);
      directions_.emplace_back(std::sin(a) * std::cos(e), -std::sin(e), std::cos(a) * std::cos(e));
    }
  }
}

DepthScan DepthCamera::sense(const Pose& true_pose, std::vector<CellState>* seen,
                             std::vector<std::uint32_t>* newly_seen,
                             std::span<const Walker> walkers) {
  const VoxelGrid& voxels = world_->voxels;
  const GridFrame& frame = voxels.frame();
  const double r = voxels.resolution();
  Eigen::Isometry3d T_BC = mount_.T_BC;
  if (!world_->slopes.empty()) {
    T_BC = standing(*world_, true_pose.position.head<2>(), true_pose.yaw).tilt * T_BC;
  }
  const Eigen::Isometry3d T_WC = body_transform(true_pose) * T_BC;
  const Eigen::Matrix3d R_WC = T_WC.linear();
  const Eigen::Matrix3d R_BC = T_BC.linear();
  const Eigen::Vector3d from = T_WC.translation();
  const Eigen::Vector3i start = voxels.voxel(from);
  const double max_range = options_.footprint.max_range;
  const bool perspective = options_.footprint.horizontal_fov < M_PI;

  DepthScan scan;
  scan.origin = T_BC.translation();
  scan.reach = max_range;
  if (!voxels.contains(start[0], start[1], start[2])) return scan;
  scan.hits.reserve(directions_.size());

  const int low[3] = {frame.i0, frame.j0, voxels.k0()};
  const int high[3] = {frame.i0 + frame.width - 1, frame.j0 + frame.height - 1,
                       voxels.k0() + voxels.depth() - 1};
  const std::ptrdiff_t strides[3] = {voxels.depth(),
                                     static_cast<std::ptrdiff_t>(voxels.depth()) * frame.width, 1};
  const CellState* data = voxels.data().data();
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);

  for (const Eigen::Vector3d& direction_C : directions_) {
    const Eigen::Vector3d direction = R_WC * direction_C;
    int v[3], step[3];
    double next[3], delta[3];
    std::ptrdiff_t stride[3];
    for (int a = 0; a < 3; ++a) {
      v[a] = start[a];
      step[a] = direction[a] > 0.0 ? 1 : -1;
      stride[a] = step[a] * strides[a];
      if (direction[a] == 0.0) {
        next[a] = delta[a] = std::numeric_limits<double>::infinity();
      } else {
        next[a] = ((v[a] + (direction[a] > 0.0 ? 1 : 0)) * r - from[a]) / direction[a];
        delta[a] = r / std::abs(direction[a]);
      }
    }
    auto index = static_cast<std::ptrdiff_t>(voxels.index(v[0], v[1], v[2]));
    double range = 0.0;
    bool inside = true;
    path_.clear();
    const double met = std::min(distance_to_walkers(walkers, from, direction),
                                distance_to_slopes(world_->slopes, from, direction));
    const double limit = std::min(max_range, met);
    while (range <= limit && inside && data[index] == CellState::kFree) {
      path_.push_back(static_cast<std::uint32_t>(index));
      int axis = next[0] < next[1] ? 0 : 1;
      if (next[2] < next[axis]) axis = 2;
      range = next[axis];
      next[axis] += delta[axis];
      v[axis] += step[axis];
      index += stride[axis];
      inside = v[axis] >= low[axis] && v[axis] <= high[axis];
    }
    const bool no_voxel = range > limit && met <= max_range;
    if (no_voxel) range = met;
    const bool hit = range <= max_range;
    // All draws are taken for every ray: what one ray meets does not shift the noise of the next.
    const double drop = uniform(noise_);
    const double error = normal(noise_);
    if (drop < options_.dropout) continue;
    if (hit && range < options_.footprint.min_range) continue;
    const double z = perspective ? range * direction_C.z() : range;
    const double measured =
        range + error * (options_.noise_constant + options_.noise_quadratic * z * z);
    const bool reported = hit && measured > 0.0 && measured <= max_range;
    if (reported) {
      scan.hits.emplace_back(scan.origin + R_BC * (direction_C * measured));
    } else {
      scan.misses.emplace_back(scan.origin + R_BC * (direction_C * max_range));
    }
    if (seen == nullptr) continue;
    const auto note = [&](std::uint32_t at, CellState state) {
      if ((*seen)[at] == state) return;
      (*seen)[at] = state;
      if (newly_seen != nullptr) newly_seen->push_back(at);
    };
    for (const std::uint32_t at : path_) note(at, CellState::kFree);
    if (reported && inside && !no_voxel)
      note(static_cast<std::uint32_t>(index), CellState::kOccupied);
  }
  return scan;
}

}  // namespace prospect
