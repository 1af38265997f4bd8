// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/maps/grid.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/heading_fit.h"
#include "engine/maps/heading_reach.h"
#include "engine/task/zone_map.h"
#include "models/robot_shape.h"
#include "models/types.h"

namespace prospect {

class Knobs;

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
  double tight_factor = 4.0;  ///< cost of a metre between hard and comfortable radius, >= 1
  /// A cell is a narrow passage if its clearance is less than hard_radius asks for by up to this
  /// [m]: walls that a drifting estimate drew twice close real doors, and a look from near opens
  /// them. It is passable, but so dear that it comes last; the certificate decides what is driven.
  double narrow_slack = 0.1;
  double narrow_factor = 30.0;  ///< cost of a metre there, >= tight_factor
  double unknown_factor = 1.5;  ///< times this within comfortable_radius of an unknown cell, >= 1
  /// The body, if its heading matters to where it fits; hard_radius is its circumscribed radius +
  /// d_safe then. Without one, radii alone decide.
  std::optional<RobotShape> body{};
  bool free_moves = true;  ///< of that body: it can reverse or move sideways (heading_reach.h)
  /// Of that body: it faces what is within this of its heading [rad], > 0.
  double facing = 0.5;
  /// Factor of cells that are not known but clear, 1 to 1000; 0: those are impassable.
  double unknown_travel = 0.0;
  /// Where ground may be, in W, if that is known: what is unknown beyond it is impassable.
  std::optional<Eigen::AlignedBox2d> extent{};
  std::shared_ptr<const ZoneMap> zones{};  ///< null: none
  double top_speed = 1.0;                  ///< [m/s] where no slow zone is, > 0
};

/// The knobs (models/knobs.h); radii, body, zones and the like come from robot and task.
void describe(Knobs& knobs, TraversabilityOptions& options);

/// Clearance and cost of travel of every ground cell.
///
///   clearance(c) = min_o dist(centre of c, square of o), o occupied   (box distance, exact)
///   passable(c)  = c is known free and clearance(c) + slack + narrow_slack >= hard_radius
///   factor(c)    = (clearance < hard_radius ? narrow_factor : clearance < comfortable ?
///                  tight_factor : 1) (unknown nearer than comfortable ? unknown_factor : 1)
///                  [metres of path equivalent per metre], slack included, 0 where impassable
///
/// Of a body whose heading matters, with its circumscribed radius R (heading_fit.h):
///   fits(c)     = the headings at which it keeps hard_radius - R - slack from every occupied
///                 square: all where clearance(c) + slack >= hard_radius, none nearer than the
///                 inscribed radius allows, between the two by the exact check
///   passable(c) = c is known free, fits(c) is not empty, and the body gets there from where it
///                 is, at some heading (heading_reach.h; left out where update() is given no pose)
/// So a long body passes where it fits lengthways. What is lost by looking at places without their
/// headings: where two narrow passages cross and it cannot turn, and it gets into both by other
/// ways, a path from one into the other seems to lead through the crossing.
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
/// other, and the result depends on the last one alone. The reach of a body whose heading matters
/// is computed anew each time, in time linear in the cells that it can be on. Value type.
/// Thread-safety: concurrent reads are safe, update() is not. Source: formulation, section 6 ("V is
/// passable exactly where the hard constraint holds"); factors and slack from the prototype.
class Traversability {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit Traversability(const TraversabilityOptions& options);

  /// Brings the clearances up to `ground`. Where it continues() the last map, only what differs is
  /// computed; else all. pose: of the body now, finite; of use only if its heading matters.
  void update(const GroundMap& ground, const Pose* pose = nullptr, const PausePoint& pause = {});
  /// Whether `ground` can be a later state of the last map (frame_of_both()), or is the first.
  bool continues(const GroundMap& ground, const PausePoint& pause = {}) const;

  /// Other zones from the next update() on: nothing else is forgotten, and what they change is
  /// among changed_factors().
  void set_zones(std::shared_ptr<const ZoneMap> zones);

  /// Makes the cells within `radius` [m] of the centre of `c` impassable, whatever the map says: a
  /// gap that could not be passed. Adds them to changed_factors(). A cell that is closed twice must
  /// be opened twice.
  void close(Cell c, double radius) { shut(c, radius, 1); }
  /// Takes a close() back, given the same arguments.
  void reopen(Cell c, double radius) { shut(c, radius, -1); }

  /// Cells whose CellState differs from that at the previous update, in scan order of the tiles.
  const std::vector<Cell>& changed_states() const { return changed_states_; }
  /// Those of them that were unknown.
  const std::vector<Cell>& newly_known() const { return newly_known_; }
  /// Likewise cells whose see_through() differs.
  const std::vector<Cell>& changed_sights() const { return changed_sights_; }
  /// Cells whose factor differs from that at the previous update.
  const std::vector<Cell>& changed_factors() const { return changed_factors_; }
  /// Cells at which a body whose heading matters gets to other headings than at the previous
  /// update.
  const std::vector<Cell>& changed_headings() const { return changed_headings_; }
  /// Whether the last update covered the whole map, for want of a usable past.
  bool restarted() const { return restarted_; }

  /// Holds the map at the last update and one tile more on every side, all unknown: frontier cells
  /// just beyond the map have an address in it, and its outermost cells are impassable. Larger if
  /// the map was. Of a map of more than KnownExtent::kAlways cells it holds what is known of it.
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
  /// clearance(c) + slack >= hard_radius, or room at some heading: room for the robot, as far as
  /// walls are known. Whatever the state of the cell; true outside the map.
  bool clear(Cell c) const {
    return occupied_sq_.get(c, limit_sq_) >= hard_sq_ || fitting(c) != kNoHeading;
  }
  /// Known free, not closed, and clear: passable, whether the robot gets there or not.
  bool fits(Cell c) const {
    return fit_ == nullptr ? passable(c) : headings_.get(c, kNoHeading) != kNoHeading;
  }
  bool passable(Cell c) const { return factor(c) > 0.0F; }
  /// Passable, but narrower than hard_radius asks for.
  bool narrow(Cell c) const { return passable(c) && !clear(c); }
  /// Headings at which the body faces a direction [rad], by options().facing and rounded to the
  /// nearest of kHeadings; all if its heading does not matter.
  HeadingMask facing(double direction) const;
  /// Whether the robot gets to the cell of that index in frame() at one of these headings. True for
  /// all of a body whose heading does not matter.
  bool turns_to(std::size_t index, HeadingMask headings) const {
    return fit_ == nullptr || (usable_.data[index] & headings) != kNoHeading;
  }
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
  static GridFrame with_rim(const GroundMap& ground, const PausePoint& pause);
  bool as_before(const GroundMap& ground, Cell tile) const;
  void restart(const GridFrame& frame, const PausePoint& pause);
  void widen(const GridFrame& frame, const PausePoint& pause);
  void transform(Rectangle cells, bool unknown, const PausePoint& pause);
  static void join(std::vector<Rectangle>& rectangles, const PausePoint& pause);
  void refresh_factors(const Rectangle& cells, const PausePoint& pause = {});
  void shut(Cell c, double radius, int times);
  bool has_path(std::size_t at) const;
  void refresh_usable(const PausePoint& pause);
  HeadingMask fitting(Cell c) const;
  void refresh_headings(const Rectangle& cells, const PausePoint& pause = {});
  void refresh_reach(const Pose& pose, const PausePoint& pause);
  void lay_zones(const PausePoint& pause);
  Rectangle within(Rectangle cells, int margin) const;

  TraversabilityOptions options_;
  int reach_ = 0;              // cells: influence radius, rounded up
  std::int32_t limit_sq_ = 0;  // half cells squared: where distances are truncated
  // Least squared distances, slack included.
  std::int32_t narrow_sq_ = 0, hard_sq_ = 0, comfortable_sq_ = 0;
  Grid<CellState> state_;
  Grid<std::uint8_t> see_through_;
  Grid<std::uint8_t> closed_;       // how often
  Grid<std::int32_t> occupied_sq_;  // squared distance [(cell / 2)^2], truncated
  Grid<std::int32_t> unknown_sq_;
  Grid<std::int32_t> forbidden_sq_;  // likewise to forbidden parts; empty without zones
  Grid<float> slowness_;             // of slow zones, 1 elsewhere; empty without zones
  Grid<float> factor_;
  // Of a body whose heading matters; else null and empty.
  std::shared_ptr<const HeadingFit> fit_;
  HeadingMask facing_east_ = kNoHeading;
  std::int32_t inscribed_sq_ = 0;  // nothing fits nearer than this [half cells squared]
  Grid<HeadingMask> headings_;     // that fit at free cells that are not closed
  HeadingReach reach_of_body_;
  Grid<HeadingMask> usable_;  // those of headings_ that the body gets to
  std::vector<Cell> changed_headings_;
  bool confined_ = false;  // cells out of its reach are impassable
  std::int64_t explored_cells_ = 0;
  bool fresh_ = true;
  bool zones_moved_ = false;
  bool restarted_ = true;
  std::vector<Cell> changed_states_;
  std::vector<Cell> newly_known_;
  std::vector<Cell> changed_sights_;
  std::vector<Cell> changed_factors_;
  std::vector<std::int32_t> scratch_;
};

}  // namespace prospect
