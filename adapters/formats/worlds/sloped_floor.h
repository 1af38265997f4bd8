// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "adapters/formats/worlds/world.h"
#include "engine/maps/grid.h"
#include "engine/maps/voxel_grid.h"

namespace prospect {

/// Height of the floor's surface [m]: the highest slope there, 0 where there is none.
double floor_height(const World& world, const Eigen::Vector2d& p);

/// How a robot stands: the plane that fits the floor under its wheels, which are taken for a circle
/// of kWheels about B's origin. Our choice.
struct Standing {
  static constexpr double kWheels = 0.15;  ///< [m]
  double height = 0.0;                     ///< [m] of the floor under B's origin
  /// From B to a frame of the same heading that is upright.
  Eigen::Matrix3d tilt = Eigen::Matrix3d::Identity();
};
Standing standing(const World& world, const Eigen::Vector2d& at, double yaw);

/// Where a ray first meets a slope, its side or its top [m along a unit direction]; infinity: it
/// does not. A ray that begins inside meets it at once.
double distance_to_slopes(std::span<const Slope> slopes, const Eigen::Vector3d& from,
                          const Eigen::Vector3d& direction);

/// Whole layers of voxels below the floor's surface in each column of a world, from z = 0 on.
Grid<int> floor_levels(const World& world);

/// The world's voxels as a robot meets them that gets over a step [m]: heights count from each
/// column's own floor, and columns that it cannot get on to have none, as over a hole: those whose
/// floor lies higher than that beside it by more than the step and a ramp's rise (kSteepest of
/// floor_join.h), and those of ramps that are steeper. Where all is flat, the world's own.
std::shared_ptr<const VoxelGrid> over_the_floor(const World& world, double step);
/// A world with these voxels and without slopes.
World flattened(const World& world, double step);

}  // namespace prospect
