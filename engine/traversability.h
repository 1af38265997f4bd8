#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/grid.h"
#include "engine/ground_map.h"
#include "engine/zone_map.h"

namespace prospect {

struct TraversabilityOptions {
  /// The hard constraint: least distance [m] of the robot's centre to an occupied cell, that is the
  /// circumscribed radius of the shape (its inscribed radius where the planner may turn it) +
  /// d_safe.
  double hard_radius = 0.23;
  /// Below this clearance [m] a cell is passable but dear; >= hard_radius.
  double comfortable_radius = 0.35;
  /// A cell is passable if its centre's clearance + lattice_slack >= hard_radius [m]. The centre
  /// line of a gap that is an even number of cells wide lies on cell edges, never on a centre, so a
  /// lattice without slack is stricter than the constraint it stands for. Choose the radii against
  /// the lattice: two radii less than a cell apart are often the same set of cells.
  double lattice_slack = 0.02;
  double tight_factor = 4.0;    ///< cost of a metre between hard and comfortable radius, >= 1
  double unknown_factor = 1.5;  ///< times this within comfortable_radius of an unknown cell, >= 1
  /// Factor of cells that are not known but clear, 1 to 1000; 0: those are impassable.
  double unknown_travel = 0.0;
  std::shared_ptr<const ZoneMap> zones{};  ///< null: none
  double top_speed = 1.0;                  ///< [m/s] where no slow zone is, > 0
};

/// Clearance and cost of travel of every ground cell.
///
///   clearance(c) = min_o dist(centre of c, square of o), o occupied   (box distance, exact)
///   passable(c)  = c is known free and clearance(c) + slack >= hard_radius
///   factor(c)    = (clearance < comfortable ? tight_factor : 1) (unknown nearer than comfortable ?
///                  unknown_factor : 1)   [metres of path equivalent per metre], 0 where impassable
///
/// With zones, clearance(c) is at most the centre's distance to their forbidden parts, and a cell
/// in a slow zone costs top_speed / limit times as much, if that is more.
///
/// The distance is to the square of a cell, not to its centre, hence the same number as the
/// certificate's distance between a disc and the occupied boxes. Squared distances are kept as
/// integers (in half cells), truncated at the comfortable radius, so the transform is exact and
/// an update equals a computation from scratch bit for bit.
///
/// update() redoes only cells within comfortable_radius of cells that changed. It finds them by
/// comparing the map with what it was, tile by tile (0.1 ms at 400 m^2): any map may follow any
/// other, and the result depends on the last one alone. Value type. Thread-safety: concurrent reads
/// are safe, update() is not. Source: formulation, section 6 ("V is passable exactly where the hard
/// constraint holds"); factors and slack from the prototype.
class Traversability {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit Traversability(const TraversabilityOptions& options);

  /// Brings the clearances up to `ground`. Where it continues() the last map, only what differs is
  /// computed; else all.
  void update(const GroundMap& ground);
  /// Whether `ground` can be a later state of the last map (frame_of_both()), or is the first.
  bool continues(const GroundMap& ground) const;

  /// Makes the cells within `radius` [m] of the centre of `c` impassable from now on, whatever the
  /// map says: a gap that could not be passed. Adds them to changed_factors().
  void close(Cell c, double radius);

  /// Cells whose CellState differs from that at the previous update, in scan order of the tiles.
  const std::vector<Cell>& changed_states() const { return changed_states_; }
  /// Those of them that were unknown.
  const std::vector<Cell>& newly_known() const { return newly_known_; }
  /// Likewise cells whose see_through() differs.
  const std::vector<Cell>& changed_sights() const { return changed_sights_; }
  /// Cells whose factor differs from that at the previous update.
  const std::vector<Cell>& changed_factors() const { return changed_factors_; }
  /// Whether the last update covered the whole map, for want of a usable past.
  bool restarted() const { return restarted_; }

  /// Holds the map at the last update and one tile more on every side, all unknown: frontier cells
  /// just beyond the map have an address in it, and its outermost cells are impassable. Larger if
  /// the map was.
  const GridFrame& frame() const { return state_.frame; }
  CellState state(Cell c) const { return state_.get(c, CellState::kUnknown); }
  const Grid<CellState>& states() const { return state_; }
  /// Nonzero where the sensor looks through the cell (GroundMap::see_through).
  const Grid<std::uint8_t>& see_through() const { return see_through_; }
  /// [m], truncated to clearance_limit(); that limit outside the map.
  double clearance(Cell c) const;
  /// Distance [m] to the square of the nearest unknown cell, likewise truncated; 0 outside the map.
  double unknown_clearance(Cell c) const;
  double clearance_limit() const;
  /// clearance(c) + slack >= hard_radius: room for the robot, as far as walls are known. Whatever
  /// the state of the cell; true outside the map.
  bool clear(Cell c) const { return occupied_sq_.get(c, limit_sq_) >= hard_sq_; }
  bool passable(Cell c) const { return factor(c) > 0.0F; }
  float factor(Cell c) const { return factor_.get(c, 0.0F); }
  const Grid<float>& factors() const { return factor_; }
  /// Explored cells (free or occupied), times the area of a cell [m^2].
  double explored_area() const;
  const TraversabilityOptions& options() const { return options_; }

 private:
  struct Rectangle {
    int i0, j0, i1, j1;  // inclusive
    bool empty() const { return i1 < i0; }
    void add(int i, int j);
    std::int64_t area() const;
  };
  static GridFrame with_rim(const GroundMap& ground);
  bool as_before(const GroundMap& ground, Cell tile) const;
  void restart(const GridFrame& frame);
  void widen(const GridFrame& frame);
  void transform(Rectangle cells, bool unknown);
  void refresh_factors(const Rectangle& cells);
  void lay_zones();
  Rectangle within(Rectangle cells, int margin) const;

  TraversabilityOptions options_;
  int reach_ = 0;              // cells: influence radius, rounded up
  std::int32_t limit_sq_ = 0;  // half cells squared: where distances are truncated
  std::int32_t hard_sq_ = 0, comfortable_sq_ = 0;  // least squared distances, slack included
  Grid<CellState> state_;
  Grid<std::uint8_t> see_through_;
  Grid<std::uint8_t> closed_;
  Grid<std::int32_t> occupied_sq_;  // squared distance [(cell / 2)^2], truncated
  Grid<std::int32_t> unknown_sq_;
  Grid<std::int32_t> forbidden_sq_;  // likewise to forbidden parts; empty without zones
  Grid<float> slowness_;             // of slow zones, 1 elsewhere; empty without zones
  Grid<float> factor_;
  std::int64_t explored_cells_ = 0;
  bool fresh_ = true;
  bool restarted_ = true;
  std::vector<Cell> changed_states_;
  std::vector<Cell> newly_known_;
  std::vector<Cell> changed_sights_;
  std::vector<Cell> changed_factors_;
  std::vector<std::int32_t> scratch_;
};

}  // namespace prospect
