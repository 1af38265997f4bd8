// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "engine/maps/grid.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/traversability.h"

namespace prospect {

class Knobs;

struct FrontierOptions {
  double min_length = 0.2;    ///< [m] smallest cluster: number of cells x resolution
  double sensor_range = 4.0;  ///< r_max [m]
  /// A viewpoint stands within sensor_range - range_margin [m], where the exploration gain counts a
  /// look as seven eighths of one (FootprintVisibility: (inset + 2) range_scale).
  double range_margin = 0.6;
  int rays = 90;               ///< directions tried from each frontier cell
  double near_distance = 1.0;  ///< [m]
  double near_slope = 0.3;     ///< cost of a viewpoint per metre up to near_distance; 1 beyond
};

/// The knobs (models/knobs.h); sensor_range is the depth sensor's.
void describe(Knobs& knobs, FrontierOptions& options);

/// Cost [m of path equivalent] of looking at a frontier cell from a distance [m]: near_slope d up
/// to near_distance, slope 1 beyond, where looking from farther off saves no more than driving
/// nearer.
double viewpoint_cost(double distance, const FrontierOptions& options);

/// A maximal 8-connected set of frontier cells: unknown cells with a known-free 4-neighbour.
struct Frontier {
  std::vector<Cell> cells;                             ///< in scan order
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  ///< of cell centres, in W [m]
  double length = 0.0;                                 ///< number of cells x resolution [m]
  int ignored_cells = 0;  ///< cells that do not count for now (FrontierUtility::view_ranges())
  int viewpoints = 0;     ///< entries of its cells' viewpoint lists; 0: no pose can see it
  /// Long enough, and some cell that counts has a viewpoint.
  bool active = false;
  double expected_gain =
      0.0;  ///< A: unknown ground that a look at it may show [m^2] (FrontierUtility)
  double confidence = 1.0;  ///< mean of tau over its cells [-]
  double area = 0.0;  ///< E: what it is expected to show, after what observations have shown [m^2]
  bool given_up = false;  ///< a visit to it has failed since anything new was seen there
};

/// Initial value of the cost-to-go at one traversable cell.
struct ViewpointSource {
  Cell cell;
  /// [m]: min over what it sees of viewpoint_cost + price of the observation.
  float cost = 0.0F;
  Cell sees;          ///< the frontier cell that gives the minimum
  int frontier = -1;  ///< its index in frontiers()
};

/// What looking from a viewpoint at a frontier cell costs beside viewpoint_cost() [m of path
/// equivalent], >= 0.
using ViewPrice = std::function<double(Cell viewpoint, Cell sees)>;

/// From how near each cell of a frontier must be looked at [m]: one entry a cell; 0: it does not
/// count; more than sensor_range - range_margin counts as that.
using ViewRanges = std::function<void(const Frontier& frontier, std::vector<float>& ranges)>;

/// Finds frontiers and the viewpoints from which they can be seen, by changed tile.
///
/// A frontier is active only if a line of sight, through cells that are seen through
/// (GroundMap::see_through: over a low obstacle too), joins one of its unknown cells to a
/// traversable cell within sensor_range - range_margin, or nearer (ViewRanges). Frontiers in
/// pockets that no pose can see otherwise hold a planner for ever. A body whose heading matters
/// must get there at a heading at which it faces the cell (Traversability::turns_to).
///
/// Frontier cells are kept per tile and found again only in tiles that changed. The viewpoints of
/// the frontier cells of one tile and one cluster ("piece") are cached and cast again only if the
/// piece's cells changed or a cell within the reach of its rays did. Lines are those of `rays`
/// fixed directions through the centre of the frontier cell; every cell that a line pierces counts,
/// so it cannot slip between two occupied cells that touch at a corner.
///
/// Value type. Thread-safety: concurrent reads are safe, updates are not. Deterministic: the result
/// depends only on the present map, the ranges and what is led to, not on the history.
/// Source: formulation, section 6; constants from the prototype.
class FrontierDetector {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit FrontierDetector(const FrontierOptions& options);

  /// Finds the frontier cells and clusters of the map that `traversability` was just updated to.
  void update(const Traversability& traversability, const PausePoint& pause = {});

  /// Casts viewpoints and sets Frontier::active. ranges: null: all cells count, at full range.
  void find_viewpoints(const Traversability& traversability, const ViewRanges& ranges = nullptr,
                       const PausePoint& pause = {});

  /// From now on the viewpoints of this frontier alone are sources; -1: there are none.
  /// price: asked of each of them, null: looks cost nothing more.
  /// Of what can be seen of one cluster in one tile, the cell nearest the viewpoint stands for all.
  void set_goal(int frontier, const ViewPrice& price = nullptr, const PausePoint& pause = {});

  /// Calls visit(frontier, cell, sees, viewpoint_cost [m]) for every viewpoint of every active
  /// frontier and the frontier cell that it sees best; a cell that sees several pieces of one comes
  /// as often.
  template <typename Visit>
  void visit_viewpoints(const Visit& visit) const {
    for (const Piece& piece : pieces_) {
      for (const Entry& e : piece.entries) {
        visit(piece.frontier, e.cell, piece.cells[static_cast<std::size_t>(e.sees)],
              static_cast<double>(e.cost));
      }
    }
  }

  const std::vector<Frontier>& frontiers() const { return frontiers_; }
  /// Index of the frontier a cell belongs to, -1 for none.
  int frontier_of(Cell c) const { return label_.get(c, -1); }

  /// Source value of a cell [m], +infinity where it is no viewpoint; and what it sees.
  float source(Cell c) const;
  ViewpointSource source_at(Cell c) const;
  /// Cells whose source value differs from that after the previous set_goal().
  const std::vector<Cell>& changed_sources() const { return changed_sources_; }
  /// All sources, in scan order (for tests and reports: linear in the map).
  std::vector<ViewpointSource> sources() const;
  const GridFrame& frame() const { return label_.frame; }
  const FrontierOptions& options() const { return options_; }
  /// Frontier cells whose rays were cast in the last find_viewpoints().
  int cells_cast() const { return cells_cast_; }

 private:
  struct Entry {
    Cell cell;
    float cost = 0.0F;   // [m]
    int sees = 0;        // index in Piece::cells
    float price = 0.0F;  // [m] of the observation; of the frontier that is led to
  };
  struct Rectangle {
    int i0 = 0, j0 = 0, i1 = -1, j1 = -1;  // inclusive
    bool empty() const { return i1 < i0; }
    void add(Cell c);
    bool meets(const Rectangle& other) const;
    bool contains(Cell c) const { return c.i >= i0 && c.i <= i1 && c.j >= j0 && c.j <= j1; }
  };
  // The frontier cells of one tile and one cluster that count, and what can be seen of them.
  struct Piece {
    std::vector<Cell> cells;
    std::vector<float> ranges;  // by cell [m]
    std::vector<Entry> entries;
    Rectangle touched;  // cells that its rays looked at
    int frontier = -1;
  };
  struct Ray {
    double angle = 0.0;  // [rad], from the frontier cell
    std::vector<Cell> offsets;
    std::vector<float> distances;  // [m]
    std::vector<float> costs;
  };
  void relayout(const Traversability& traversability, const PausePoint& pause);
  void make_rays(double resolution);
  void find_cells(const Traversability& traversability, const PausePoint& pause);
  void cluster(const PausePoint& pause);
  void cast(const Traversability& traversability, Piece& piece, const PausePoint& pause);
  int tiles_x() const { return label_.frame.width / GroundMap::kTile; }
  std::size_t tile_of(Cell c) const;

  FrontierOptions options_;
  double rays_resolution_ = 0.0;
  std::vector<Ray> rays_;
  std::vector<std::vector<Cell>> tile_cells_;  // frontier cells by tile, in scan order
  Grid<int> label_;  // frontier index; -1: no frontier cell; -2: not labelled yet
  Grid<std::uint8_t> passable_;
  std::vector<Frontier> frontiers_;
  std::deque<Piece> pieces_;  // ordered by frontier, then tile; not moved as they grow
  std::vector<Rectangle>
      moved_;  // by tile: cells whose freedom or passability changed since the last cast
  Grid<float> source_;
  std::vector<Cell> changed_sources_;
  int led_to_ = -1;        // frontier whose viewpoints are the sources
  std::vector<Cell> led_;  // cells with a source
  Grid<float> best_;
  Grid<int> best_index_;
  std::vector<Cell> marked_;
  std::vector<Cell> stack_;
  Grid<int> piece_at_;  // old piece by its first cell, while matching; else -1
  int cells_cast_ = 0;
};

}  // namespace prospect
