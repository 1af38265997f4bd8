#pragma once

#include <cstdint>

#include "adapters/worlds/world.h"
#include "engine/grid.h"

namespace prospect {

/// Columns of the world's lattice that are free over the whole body slice: 1 where every voxel
/// layer that overlaps (z_min, z_max) is kFree, else 0.
Grid<std::uint8_t> free_columns(const VoxelGrid& voxels, const BodySlice& slice);

/// Columns on whose centre the robot can stand: 1 where the distance from the column's centre to
/// the nearest point of any column that is not free (free_columns; everything outside the grid is
/// not free) is at least the standing clearance, else 0. Exact, in one pass over the obstacle
/// outline.
Grid<std::uint8_t> standing_columns(const VoxelGrid& voxels, const BodySlice& slice);

/// The part of a mask that is connected to `seed` by steps to the four neighbours; all 0 if the
/// mask is 0 at the seed.
Grid<std::uint8_t> connected_component(const Grid<std::uint8_t>& mask, Cell seed);

struct ReachableAreaOptions {
  BodySlice slice;
  double range = 4.0;           ///< r_max of the sensor, horizontal [m]
  double sensor_height = 0.4;   ///< of the optical centre above the floor [m]
  double map_resolution = 0.1;  ///< of the ground cells, world-aligned [m]
};

/// The denominator of coverage: what a perfect sensor could see from where the robot can stand.
///
/// Definition (our choice; formulation and prototype only say "visible from the start's
/// component").
///  - A is the 4-connected component of standing_columns that holds the start.
///  - A ground cell c of the lattice of map_resolution belongs to the reachable area iff
///    (1) every world column assigned to it is free over the body slice; a column is assigned to
///    the
///        cell that its centre lies in, and a cell to which no column is assigned (map finer than
///        the world) takes the column that holds the cell's centre; and
///    (2) the column h that holds the centre of c is seen: h is in A, or some column a in A that is
///        free in the layer of the sensor height has its centre within `range` of the centre of h,
///        and the segment between the two centres meets the interior of columns that are free in
///        that layer only; through a corner it passes unless both columns beside the corner are not
///        free. (Any heading, no limit of the field of view, no minimum range.)
///
/// Computed apart from planner, mapper and simulator: of those only VoxelGrid is used, as data.
struct ReachableArea {
  Grid<std::uint8_t> cells;     ///< 1: the ground cell belongs to the reachable area
  double area = 0.0;            ///< [m^2]
  Grid<std::uint8_t> standing;  ///< A, on the world's own lattice
};

/// Throws InputError (one line, with the world's name) if the robot cannot stand at the world's
/// start, saying what clearance there is and what is expected. Deterministic. The sensor height
/// must lie within the body slice's or the world's layers; std::invalid_argument for non-finite or
/// non-positive options.
ReachableArea reachable_area(const World& world, const ReachableAreaOptions& options = {});

}  // namespace prospect
