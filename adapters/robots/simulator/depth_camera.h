// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/walkers.h"
#include "models/camera.h"
#include "models/types.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

class Knobs;

struct DepthCameraOptions {
  RgbdFootprint footprint;
  /// Rays, evenly spaced in azimuth and elevation over the footprint (pixel centres).
  int columns = 80;
  int rows = 60;
  /// Range noise, one standard deviation: noise_constant + noise_quadratic z^2 [m; 1/m], z the
  /// depth along the optical axis; from a field of view of 180 degrees on, which no image in
  /// perspective has, the range. The defaults are those of a structured-light camera.
  double noise_constant = 0.0015;
  double noise_quadratic = 0.0016;
  double dropout = 0.02;  ///< probability that a ray gives no valid measurement
};

/// The knobs (models/knobs.h) of the noise; footprint and rays come from the robot's sensor.
void describe(Knobs& knobs, DepthCameraOptions& options);

/// Columns and rows at the spacing that the defaults have in the default footprint (0.9 degrees),
/// at least one of each.
inline void set_resolution(DepthCameraOptions& options) {
  const DepthCameraOptions fallback;
  const auto rays = [](int standard, double angle, double standard_angle) {
    return std::max(1, static_cast<int>(std::lround(standard * angle / standard_angle)));
  };
  options.columns =
      rays(fallback.columns, options.footprint.horizontal_fov, fallback.footprint.horizontal_fov);
  options.rows =
      rays(fallback.rows, options.footprint.vertical_fov, fallback.footprint.vertical_fov);
}

/// Depth camera or lidar, ray-cast against a world's true voxels with an exact traversal.
///
/// A ray at azimuth a and elevation e looks along (sin a cos e, -sin e, cos a cos e) in C. It gives
///   a hit   at range s + noise, if the first solid voxel is entered at s, min_range <= s, and the
///           noisy range is at most max_range;
///   a miss  if there is no solid voxel within max_range (or the noisy range lies beyond);
///   nothing if s < min_range, or by drop-out.
/// Voxels that are not kFree, and everything outside the grid, are solid.
/// Thread-safety: one thread. Deterministic in (world, options, seed, sequence of poses).
class DepthCamera {
 public:
  /// Throws std::invalid_argument on options out of range.
  DepthCamera(const World& world, const DepthCameraOptions& options, const CameraMount& mount,
              std::uint64_t seed);

  /// One image from the true body pose; points in the body frame B [m], origin included. On a ramp
  /// the sensor tilts with the body (sloped_floor.h), and B here is upright: gravity tells.
  /// If `seen` is given (size of world.voxels.data()), voxels that a valid ray passed are set to
  /// kFree there, and voxels that one ended in to kOccupied; `newly_seen`, if given, receives the
  /// indices of those whose entry changed. Rays that meet somebody or a slope end there, in no
  /// voxel.
  DepthScan sense(const Pose& true_pose, std::vector<CellState>* seen = nullptr,
                  std::vector<std::uint32_t>* newly_seen = nullptr,
                  std::span<const Walker> walkers = {});

  const DepthCameraOptions& options() const { return options_; }
  const CameraMount& mount() const { return mount_; }
  /// Unit directions of the rays in C, row by row from the top left.
  const std::vector<Eigen::Vector3d>& directions() const { return directions_; }

 private:
  const World* world_;
  DepthCameraOptions options_;
  CameraMount mount_;
  std::vector<Eigen::Vector3d> directions_;
  std::mt19937_64 noise_;
  std::vector<std::uint32_t> path_;  // voxels of the ray at hand
};

/// Pose of the camera in W, T_WC, for a body pose and a mount.
Eigen::Isometry3d camera_pose(const Pose& body, const CameraMount& mount);

}  // namespace prospect
