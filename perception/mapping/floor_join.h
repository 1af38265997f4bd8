// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "engine/maps/grid.h"

namespace prospect {

/// The steepest ramp that is ground [m a metre]: 8 degrees.
inline constexpr double kSteepest = 0.1405408;

/// [m] by which a ramp is uneven over a way [m], or is seen to be: over a metre half of what tells
/// 8 degrees from 12, and between neighbours less than a kerb. Our choice.
constexpr double unevenness(double way) { return 0.03 * std::min(1.0, way / 0.3); }

inline constexpr double kHeightRounding = 1e-9;  ///< [m]

/// [m] by which floors may differ in height that join and lie `way` [m] apart on the ground: a
/// step, or what the steepest ramp rises on that way.
constexpr double most_that_joins(double way, double step) {
  return std::max(step, kSteepest * way + unevenness(way));
}
/// Whether floors join that lie `rise` [m] apart in height.
constexpr bool joins(double rise, double way, double step) {
  return rise <= most_that_joins(way, step) + kHeightRounding;
}

/// A surface with room above.
struct FloorSurface {
  int k = 0;            ///< its layer of voxels
  double z = 0.0;       ///< [m] its height
  bool level = false;   ///< what was met of it lies so, and it is no foot of what stands there
  bool is_low = false;  ///< it is higher than a step, below a body, and no such foot: a kerb
};

/// The height h of the ground, cell by cell, where the floor is not flat.
///
///   flat     a cell with a surface below the body's layers and h <= step: as it is on a flat
///            floor, whatever is around it;
///   raised   one without, of whose surfaces one joins() the ground of one of eight neighbours; of
///            several that which is nearest in height. Below the body's layers only if it is level;
///   none     all others. A table is none, and of two storeys over each other the one is ground
///            that joins.
/// Ground grows from the flat floor over raised cells, each of which remembers the neighbour that
/// it joins: where that goes, so does what grew from it, unless it joins another one.
///
/// Closed is
///   low    a cell without ground, with a surface that is_low;
///   edge   a cell whose ground lies higher than a neighbour's and does not join it; one without
///          ground between two such within two cells of it;
///   steep  a cell on a line of joined ground, along one of eight directions and at most kBaseline
///          long, whose ends do not join; if the ground slopes there, too.
///
/// Reached is flat ground, and raised ground that joins a neighbour's which is reached and not
/// closed. What is not, as a platform over a ramp that is too steep, is a thing like any other.
///
/// Level L: by how many layers a column is let down, so that its floor lies where a flat one does.
///   flat  L = 0;   raised and reached  L = floor((h + kAbove) / r): what is met up to kAbove over
///   the floor is floor;   none  that of the nearest ground within kSpread cells that is reached
///   and not closed;   else 0.
///
/// Only what has changed is looked at: the cost of look() is that of the cells whose ground has
/// moved by kSettled or more, and of those near them. A flat floor costs nothing but its
/// candidates. Deterministic; where several grounds could be joined the order of the looks decides.
/// Thread-safety: as a value.
class FloorJoin {
 public:
  static constexpr double kBaseline = 1.0;  ///< [m]; our choice
  static constexpr double kAbove = 0.03;    ///< [m]; our choice: three sigma of a height
  static constexpr double kSettled = 0.01;  ///< [m]; our choice
  static constexpr int kSpread = 5;         ///< [cells]; our choice
  static constexpr int kTile = 16;          ///< [cells]

  /// Calls back with the surfaces of a cell, appended in any order.
  using Surfaces = std::function<void(Cell, std::vector<FloorSurface>&)>;

  /// k_body: the lowest layer that a body sweeps on a flat floor, 0 or more. step [m].
  FloorJoin(double resolution, int k_body, double step);

  /// Looks at cells whose surfaces may have changed, and at what depends on them.
  void look(const std::vector<Cell>& cells, const Surfaces& surfaces);
  /// Whose level, or being closed, is another one since the last look. No cell twice.
  const std::vector<Cell>& changed() const { return changed_; }

  /// Nothing is raised or closed anywhere.
  bool is_flat() const { return spots_.data.empty(); }
  /// Whether the cell is near what is not flat: what changes in it is to be looked at.
  bool is_near(Cell c) const { return find(c) != nullptr; }
  /// [m] NaN: none is known, or it is far from what is not flat.
  float height(Cell c) const;
  int level(Cell c) const;
  /// Of a square of cells from `first` on, row by row, that lies in one tile of kTile.
  void levels(Cell first, int side, int* into) const;
  bool closed(Cell c) const;
  /// [m] no ground was ever higher.
  double highest() const { return highest_; }
  /// [m] no ground of a cell lies farther than that above all of its neighbours'.
  double most_rise() const { return most_rise_; }

 private:
  static constexpr std::uint8_t kFlat = 8, kNone = 9;  // instead of a direction

  struct Spot {
    float height = std::numeric_limits<float>::quiet_NaN();
    std::int16_t level = 0;
    std::uint8_t joined_to = kNone;   // the direction of the neighbour
    std::uint8_t reached_by = kNone;  // the same
    bool looked = false, low = false, closed = false;
    bool own = false;         // the level is that of its own ground
    bool here = false;        // its tile is near what is not flat
    std::uint32_t noted = 0;  // the newest list that holds it
  };

  static Cell tile_of(Cell c) { return {floor_divide(c.i, kTile), floor_divide(c.j, kTile)}; }
  const Spot* find(Cell c) const {
    if (!spots_.frame.contains(c)) return nullptr;
    const Spot& s = spots_[c];
    return s.here ? &s : nullptr;
  }
  Spot* find(Cell c) { return const_cast<Spot*>(std::as_const(*this).find(c)); }
  void add_tile(Cell tile);
  Spot& spot(Cell c);
  float ground(Cell c);
  /// The same of a cell that is less than a stencil from a tile: `at` in spots_.
  float ground(Cell c, std::ptrdiff_t at) {
    const Spot& s = spots_.data[static_cast<std::size_t>(at)];
    return s.here && s.looked ? s.height : ground(c);
  }
  const FloorSurface* flat_of(const std::vector<FloorSurface>& found) const;
  const FloorSurface* joining(const std::vector<FloorSurface>& found, double from,
                              double way) const;
  void set_ground(Cell c, Spot& s, double z, std::uint8_t joined_to);
  void review(Cell c);
  void let_go(Cell c);
  void grow();
  void close_low(Cell c);
  int level_of(Cell c, const Spot& s);
  bool is_edge(Cell c, const Spot& s);
  bool is_steep(Cell c);
  bool is_reached(const Spot& s) const { return s.joined_to == kFlat || s.reached_by != kNone; }
  void reach(const std::vector<Cell>& shut);
  void judge();

  double r_, step_, highest_, most_rise_;
  int k_body_, reach_;  // reach: of the baseline [cells]
  const Surfaces* surfaces_ = nullptr;
  /// Of all tiles and more than a stencil about them: what a cell is asked of never lies outside.
  Grid<Spot> spots_;
  std::uint32_t list_ = 0;
  std::vector<Cell> queue_, moved_, reached_, changed_;
  std::vector<FloorSurface> found_, beside_;
  std::vector<double> line_;
  /// By how much heights on a line differ that join, so many cells apart: straight and diagonal.
  std::vector<double> limits_[2];
};

}  // namespace prospect
