// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/maps/voxel_grid.h"

namespace prospect {

struct WallThicknessOptions {
  double z_min = 0.2;  ///< [m]: the part of a column that is looked at
  double z_max = 2.2;
  double least = 0.5;     ///< [m] of occupied voxels that make a ground cell one of a wall
  double window = 0.5;    ///< [m]: radius of the cells that give a wall's direction
  double straight = 0.3;  ///< largest ratio of the cells' variances across and along it
  double gap = 0.2;       ///< [m] without wall that is bridged
  double doubled = 3.0;   ///< [cells]: thicker is doubled
};

/// How thick walls are in a map: a wall that was entered twice, because poses were off, is thicker
/// than one that was entered once, or has a second layer behind a gap.
///
/// A ground cell belongs to a wall if its column is occupied over `least` between z_min and z_max.
/// The normal is the direction of least variance of the wall cells within `window`; cells where
/// that is not a line (corners, furniture) are left out. From the cell's centre, along the normal
/// both ways in steps of half a cell, wall cells are followed, gaps of up to `gap` bridged; the
/// thickness is the distance of the last ones found, plus a cell. A wall seen from one side is one
/// to two and a half cells thick, as it lies on the lattice.
///
/// Two real surfaces nearer than `gap` (a cupboard before a wall) count, too: compare maps of one
/// place, not places.
struct WallThickness {
  int cells = 0;         ///< that were measured
  double median = 0.0;   ///< [m]; NaN without cells
  double p90 = 0.0;      ///< [m]
  double doubled = 0.0;  ///< share of the cells where it is thicker than `doubled`
};
WallThickness wall_thickness(const VoxelGrid& voxels, const WallThicknessOptions& options = {});

}  // namespace prospect
