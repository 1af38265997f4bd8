// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "engine/maps/grid.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/map_projection.h"
#include "models/types.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

/// What valid depth rays have really seen of a world, whatever an estimate makes of them: its
/// columns, by the rule of the ground map (any voxel of the slice over the floor seen, solid or
/// free). For evaluation. Thread-safety: one thread changes it.
class SeenArea {
 public:
  SeenArea(const World& world, const HeightSlice& slice);

  /// One image of `camera` from a true pose, entered; points in B. What is behind people is not
  /// seen.
  DepthScan look(DepthCamera& camera, const Pose& true_pose, std::span<const Walker> walkers = {});

  /// What a map knows counts as seen: the columns whose centre lies in one of its explored cells.
  void know(const GroundMap& map);

  /// Cells of the true map counted by coverage(): nonzero = counts.
  void set_reachable(const Grid<std::uint8_t>& reachable);
  /// Share of the reachable cells whose column has been seen; NaN where none is reachable.
  double coverage() const;
  double area() const;  ///< [m^2] of those cells
  bool seen(Cell true_cell) const;

 private:
  const World* world_;
  SliceLayers layers_;
  std::vector<CellState> voxels_;              // as seen, indexed like the world's
  std::vector<int> levels_;                    // of each column's floor [voxels]
  std::vector<std::uint32_t> newly_seen_;      // by the image at hand
  std::vector<std::uint16_t> free_;            // of each column, within the slice
  std::vector<std::uint8_t> column_;           // seen
  std::vector<std::int32_t> reachable_cells_;  // of each column: how many it stands for
  std::int64_t reachable_total_ = 0;
  std::int64_t reachable_seen_ = 0;
  double cell_area_ = 0.0;  // [m^2] of a reachable cell
};

}  // namespace prospect
