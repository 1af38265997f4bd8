// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "engine/maps/grid.h"

namespace prospect {

/// The octree projected on the ground plane, over the height slice that the robot's body sweeps.
/// A cell is occupied if any voxel of its column in the slice is occupied; free if none is and any
/// is known free; unknown otherwise. It is both the 2-D obstacle map and the
/// exploration map G(n): g = 1 (explored) exactly where the state is not unknown.
///
/// Beside its state a cell knows whether the sensor looks through it: a camera sees over a low
/// obstacle that stops the body, and a frontier behind one can be looked at from before it.
///
/// Changes are counted per tile (16 x 16 cells). The revisions tell states of one map apart, the
/// one that set() is called on: another map, also one projected anew from the same octree, counts
/// for itself. What is handed maps from elsewhere compares cells (Traversability does). A change of
/// frame() (the map grew) keeps all cell addresses and the revisions of the tiles that existed.
///
/// Value type; a snapshot handed out as shared_ptr<const GroundMap> never changes.
/// Thread-safety: concurrent reads are safe.
class GroundMap {
 public:
  static constexpr int kTile = 16;

  /// `frame` is widened to whole tiles.
  explicit GroundMap(const GridFrame& frame);

  const GridFrame& frame() const { return cells_.frame; }
  CellState state(Cell c) const { return cells_.get(c, CellState::kUnknown); }
  bool explored(Cell c) const { return state(c) != CellState::kUnknown; }

  /// Whether a line of sight passes the cell (see_through() of map_projection.h); false outside the
  /// map.
  bool see_through(Cell c) const { return see_through_.get(c, 0) != 0; }

  /// Sets a cell; grows the map (with a margin) if the cell lies outside. Bumps the tile's revision
  /// if state or sight really change. Without `see_through`: what is free is seen through.
  void set(Cell c, CellState state, bool see_through);
  void set(Cell c, CellState state) { set(c, state, state == CellState::kFree); }

  /// Revision of the newest change, 0 for a fresh map; strictly increasing.
  std::uint64_t revision() const { return revision_; }
  int tiles_x() const { return cells_.frame.width / kTile; }
  int tiles_y() const { return cells_.frame.height / kTile; }
  std::uint64_t tile_revision(int tx, int ty) const {
    return tile_revision_[static_cast<std::size_t>(ty * tiles_x() + tx)];
  }
  /// The rectangle of cells of a tile.
  GridFrame tile_frame(int tx, int ty) const;

  /// Number of cells that are free / occupied.
  int free_cells() const { return free_; }
  int occupied_cells() const { return occupied_; }

  const Grid<CellState>& cells() const { return cells_; }
  /// Nonzero where see_through().
  const Grid<std::uint8_t>& sights() const { return see_through_; }

 private:
  void grow_to(Cell c);

  Grid<CellState> cells_;
  Grid<std::uint8_t> see_through_;
  std::vector<std::uint64_t> tile_revision_;
  std::uint64_t revision_ = 0;
  int free_ = 0;
  int occupied_ = 0;
};

}  // namespace prospect
