// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "engine/maps/grid.h"

namespace prospect {

/// The steepest ramp that is ground [m a metre]: 8 degrees.
inline constexpr double kSteepest = 0.1405408;

/// [m] by which a ramp is uneven, or is seen to be; our choice.
inline constexpr double kUneven = 0.02;

/// Whether floors join that lie `rise` [m] apart in height and `way` [m] on the ground: by no more
/// than a step, or than the steepest ramp rises on that way.
constexpr bool joins(double rise, double way, double step) {
  return rise <= std::max(step, kSteepest * way + kUneven) + 1e-9;
}

/// A surface on which something may stand, with room above.
struct FloorSurface {
  int k = 0;       ///< its layer of voxels
  double z = 0.0;  ///< [m] its top
};

/// Which surfaces are the floor: what joins without a step.
///
/// Floor begins at all surfaces in the layers k_first <= k <= k_stand, those of z = 0 that no body
/// sweeps, and grows from cell to cell of eight neighbours: a cell without a floor takes the
/// surface that joins() a neighbour's, of several the nearest in height. So of two storeys over
/// each other the one is floor that begins it, and a table is none. Cells that no floor reaches
/// have the level of the nearest that one does.
///
/// A cell is closed whose floor does not join that of a cell at most kBaseline away along one of
/// eight directions, and lies higher; with it those between, which join each other. That holds
/// edges, thresholds that are too high, and ramps that are too steep, from their foot on.
///
/// Levels tell by how many layers a column is to be let down so that its floor lies where a flat
/// floor does, at k_stand or below: see OccupancyMapper.
/// O(cells). Deterministic. Thread-safety: as a value.
class FloorJoin {
 public:
  static constexpr double kBaseline = 1.0;  ///< [m]; our choice

  /// Calls back with the surfaces of a cell, appended in any order.
  using Surfaces = std::function<void(Cell, std::vector<FloorSurface>&)>;

  /// k_stand: the highest layer at z = 0 that no body sweeps, -1 or 0. step [m].
  FloorJoin(const GridFrame& frame, int k_stand, double step, const Surfaces& surfaces);

  const GridFrame& frame() const { return level_.frame; }
  /// NaN: none is known.
  float height(Cell c) const { return height_.get(c, std::numeric_limits<float>::quiet_NaN()); }
  int level(Cell c) const { return level_.get(c, 0); }
  bool closed(Cell c) const { return closed_.get(c, 0) != 0; }

 private:
  void grow(const std::vector<std::size_t>& first, const std::vector<FloorSurface>& all,
            int k_stand);
  void spread();
  void close();

  double step_;
  Grid<float> height_;
  Grid<std::int16_t> level_;
  Grid<std::uint8_t> closed_;
  std::vector<int> order_;  // cells with floor, as it grew
};

}  // namespace prospect
