// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/ground_map.h"

#include <algorithm>
#include <utility>

namespace prospect {
namespace {

int floor_to_tile(int a) { return floor_divide(a, GroundMap::kTile) * GroundMap::kTile; }
int ceil_to_tile(int a) { return -floor_to_tile(-a); }

GridFrame whole_tiles(const GridFrame& f) {
  GridFrame g = f;
  g.i0 = floor_to_tile(f.i0);
  g.j0 = floor_to_tile(f.j0);
  g.width = ceil_to_tile(f.i0 + std::max(f.width, 1)) - g.i0;
  g.height = ceil_to_tile(f.j0 + std::max(f.height, 1)) - g.j0;
  return g;
}

}  // namespace

GroundMap::GroundMap(const GridFrame& frame)
    : cells_(whole_tiles(frame), CellState::kUnknown), see_through_(cells_.frame, 0) {
  tile_revision_.assign(static_cast<std::size_t>(tiles_x() * tiles_y()), 0);
}

void GroundMap::set(Cell c, CellState state, bool see_through) {
  if (!cells_.frame.contains(c)) {
    if (state == CellState::kUnknown && !see_through) return;
    grow_to(c);
  }
  CellState& current = cells_[c];
  std::uint8_t& sight = see_through_[c];
  if (current == state && (sight != 0) == see_through) return;
  free_ += (state == CellState::kFree) - (current == CellState::kFree);
  occupied_ += (state == CellState::kOccupied) - (current == CellState::kOccupied);
  current = state;
  sight = see_through;
  const int tx = (c.i - cells_.frame.i0) / kTile;
  const int ty = (c.j - cells_.frame.j0) / kTile;
  tile_revision_[static_cast<std::size_t>(ty * tiles_x() + tx)] = ++revision_;
}

GridFrame GroundMap::tile_frame(int tx, int ty) const {
  return {cells_.frame.resolution, cells_.frame.i0 + tx * kTile, cells_.frame.j0 + ty * kTile,
          kTile, kTile};
}

void GroundMap::grow_to(Cell c) {
  // A margin of eight tiles keeps reallocation rare while a robot drives outward.
  constexpr int kMargin = 8 * kTile;
  const GridFrame old = cells_.frame;
  GridFrame wide = old;
  wide.i0 = c.i < old.i0 ? c.i - kMargin : old.i0;
  wide.j0 = c.j < old.j0 ? c.j - kMargin : old.j0;
  const int end_i = old.i0 + old.width, end_j = old.j0 + old.height;
  wide.width = (c.i >= end_i ? c.i + kMargin : end_i) - wide.i0;
  wide.height = (c.j >= end_j ? c.j + kMargin : end_j) - wide.j0;
  const GridFrame frame = whole_tiles(wide);
  Grid<std::uint64_t> revisions;
  revisions.frame = frame_of_blocks(old, kTile);
  revisions.data = std::move(tile_revision_);
  revisions.widen(frame_of_blocks(frame, kTile), 0);
  tile_revision_ = std::move(revisions.data);
  cells_.widen(frame, CellState::kUnknown);
  see_through_.widen(frame, 0);
}

}  // namespace prospect
