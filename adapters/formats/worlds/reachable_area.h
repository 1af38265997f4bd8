// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "adapters/formats/worlds/world.h"
#include "engine/maps/grid.h"
#include "engine/maps/heading_fit.h"
#include "engine/task/zone_map.h"

namespace prospect {

/// Columns of the world's lattice that are free over the whole body slice: 1 where every voxel
/// layer that overlaps (z_min, z_max) is kFree and the floor is not missing (floor_state.h), else
/// 0.
Grid<std::uint8_t> free_columns(const VoxelGrid& voxels, const BodySlice& slice);

/// Columns with ample room to stand: 1 where the distance from the column's centre to the nearest
/// point of any column that is not free (free_columns; everything outside the grid is not free) is
/// at least slice.standing_clearance, else 0. Exact, in one pass over the obstacle outline. By
/// distance alone, whatever the slice's shape.
Grid<std::uint8_t> standing_columns(const VoxelGrid& voxels, const BodySlice& slice);

/// The headings at which the body of the slice, with its origin on a column's centre, has `room`
/// [m] to every column that is not free (heading_fit.h); none on columns that are not free
/// themselves.
Grid<HeadingMask> fitting_headings(const VoxelGrid& voxels, const BodySlice& slice, double room);

/// The part of a mask that is connected to `seed` by steps to the four neighbours; all 0 if the
/// mask is 0 at the seed.
Grid<std::uint8_t> connected_component(const Grid<std::uint8_t>& mask, Cell seed);

struct ReachableAreaOptions {
  BodySlice slice;              ///< its standing_clearance does not matter here
  double room = 0.0;            ///< that the body keeps from everything not free [m]
  bool free_moves = true;       ///< the base can reverse or move sideways (heading_reach.h)
  double range = 4.0;           ///< r_max of the sensor, horizontal [m]
  double sensor_height = 0.4;   ///< of the optical centre above the floor [m]
  double map_resolution = 0.1;  ///< of the ground cells, world-aligned [m]
  /// The body keeps `room` from their forbidden parts, too, and looks across them; null: none.
  std::shared_ptr<const ZoneMap> zones{};
};

/// The denominator of coverage: what a perfect sensor could see from where the robot gets to. The
/// robot's own footprint decides, by the planner's rule for what is passable (traversability.h) on
/// the true world: room is what the planner keeps, less the slack of its lattice.
///
/// Definition (our choice; formulation and prototype only say "visible from the start's
/// component").
///  - A column is a place where the robot can stand if the body, with its origin on the column's
///    centre, has `room` to every column that is not free (free_columns; everything outside the
///    grid is not free): a round body (is_round) if the distance to the nearest is at least its
///    circumscribed radius + room; any other at some of kHeadings headings (heading_fit.h). So with
///    the forbidden parts of zones, which no body enters. (The start itself is always in A.)
///  - A holds those that the robot gets to: for a round body the 4-connected component of the one
///    nearest to the start, within 1 m and joined to it by a line over free columns; for any other
///    what heading_reach.h reaches from the start's pose: what it gets into by turning and driving
///    as far as it fits. If the base only drives forward, what it cannot get out of does not count.
///    A is the start's column alone where there is no such place.
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
/// Computed apart from mapper and simulator, and of the planner with its table of headings and its
/// flood over them alone.
struct ReachableArea {
  Grid<std::uint8_t> cells;     ///< 1: the ground cell belongs to the reachable area
  double area = 0.0;            ///< [m^2]
  Grid<std::uint8_t> standing;  ///< A, on the world's own lattice
  /// [m^2] that would belong to it besides, were the robot a disc of its inscribed radius: what its
  /// length keeps it from. 0 for a round body.
  double too_long_for = 0.0;
};

/// Throws InputError (one line, with the world's name) if the start's column is not free; whether
/// the body fits at the start is place_start()'s to check. Deterministic. The sensor height must
/// lie within the body slice's or the world's layers; std::invalid_argument for non-finite or
/// non-positive options.
ReachableArea reachable_area(const World& world, const ReachableAreaOptions& options = {});

}  // namespace prospect
