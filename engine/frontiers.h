#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/grid.h"
#include "engine/ground_map.h"
#include "engine/traversability.h"

namespace prospect {

struct FrontierOptions {
  double min_length = 0.5;     ///< [m] smallest cluster: number of cells x resolution
  double sensor_range = 4.0;   ///< r_max [m]
  double range_margin = 0.3;   ///< a viewpoint stands within sensor_range - range_margin [m]
  int rays = 40;               ///< directions tried from each frontier cell
  double near_distance = 1.0;  ///< [m]
  double near_slope = 0.3;     ///< cost of a viewpoint per metre up to near_distance; 1 beyond
};

/// Cost [m of path equivalent] of looking at a frontier cell from a distance [m]: near_slope d up
/// to near_distance, slope 1 beyond, where looking from farther off saves no more than driving
/// nearer.
double viewpoint_cost(double distance, const FrontierOptions& options);

/// A maximal 8-connected set of frontier cells: unknown cells with a known-free 4-neighbour.
struct Frontier {
  std::vector<Cell> cells;                             ///< in scan order
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  ///< of cell centres, in W [m]
  double length = 0.0;                                 ///< number of cells x resolution [m]
  double area = 0.0;                                   ///< number of cells x resolution^2 [m^2]
  int suppressed_cells = 0;  ///< cells that do not count for now (see FrontierMemory)
  int viewpoints = 0;        ///< entries of its cells' viewpoint lists; 0: no pose can see it
  /// Long enough, and some cell that is not suppressed has a viewpoint.
  bool active = false;
  /// Active, and the robot can drive to one of its viewpoints (set by ExplorationGuide). Where
  /// flooding stopped before it was decided, as for the viewpoints' side of the map that is farther
  /// than the robot needs, the last decision stands: true.
  bool reachable = false;
};

/// Initial value of the cost-to-go at one traversable cell.
struct ViewpointSource {
  Cell cell;
  float cost = 0.0F;  ///< [m]: min over what it sees of viewpoint_cost - bonus of the frontier
  Cell sees;          ///< the frontier cell that gives the minimum
  int frontier = -1;  ///< its index in frontiers()
};

/// Finds frontiers and the viewpoints from which they can be seen, by changed tile.
///
/// A frontier is active only if a free line, through known-free cells only, joins one of its
/// unknown cells to a traversable cell within sensor_range - range_margin. Frontiers in pockets
/// that no pose can see otherwise hold a planner for ever.
///
/// Frontier cells are kept per tile and found again only in tiles that changed. The viewpoints of
/// the frontier cells of one tile and one cluster ("piece") are cached and cast again only if the
/// piece's cells changed or a cell within the reach of its rays did. Lines are those of `rays`
/// fixed directions through the centre of the frontier cell; every cell that a line pierces counts,
/// so it cannot slip between two occupied cells that touch at a corner.
///
/// Value type. Thread-safety: concurrent reads are safe, updates are not. Deterministic: the result
/// depends only on the present map, suppression and bonuses, not on the history.
/// Source: formulation, section 6; constants from the prototype.
class FrontierDetector {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit FrontierDetector(const FrontierOptions& options);

  /// Finds the frontier cells and clusters of the map that `traversability` was just updated to.
  void update(const Traversability& traversability);

  /// Casts viewpoints and sets Frontier::active. suppressed: one entry a cell of frame(), nonzero
  /// where a frontier cell does not count; an empty grid means none.
  void find_viewpoints(const Traversability& traversability, const Grid<std::uint8_t>& suppressed);

  /// Recomputes the sources with bonus[k] [m] subtracted for frontier k (one entry a frontier).
  void set_bonuses(const std::vector<double>& bonus);

  const std::vector<Frontier>& frontiers() const { return frontiers_; }
  /// Index of the frontier a cell belongs to, -1 for none.
  int frontier_of(Cell c) const { return label_.get(c, -1); }

  /// Source value of a cell [m], +infinity where it is no viewpoint; and what it sees.
  float source(Cell c) const;
  ViewpointSource source_at(Cell c) const;
  /// Cells whose source value differs from that after the previous set_bonuses().
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
    float cost;
    Cell sees;
  };
  struct Piece {
    int tile_i = 0, tile_j = 0;  // address of the tile: cell / kTile, independent of the frame
    std::vector<Cell> cells;     // that count
    std::vector<Entry> entries;  // in scan order
    int i0 = 0, j0 = 0, i1 = -1, j1 = -1;  // cells that its rays touched
    int frontier = -1;
    double bonus = 0.0;
    bool merged = false;  // its entries are in source_ with `bonus`
  };
  void relayout(const Traversability& traversability);
  void find_cells(const Traversability& traversability);
  void cluster();
  void cast(const Traversability& traversability, Piece& piece);

  FrontierOptions options_;
  std::vector<std::vector<Cell>> rays_;  // offsets along each direction
  std::vector<std::vector<float>> ray_cost_;
  double rays_resolution_ = 0.0;
  std::vector<std::vector<Cell>> tile_cells_;  // frontier cells by tile
  Grid<int> label_;  // frontier index, -1 none, -2 frontier cell not yet labelled
  std::vector<Frontier> frontiers_;
  std::vector<Piece> pieces_;
  std::vector<Piece> dropped_;  // pieces whose entries must leave source_
  Grid<float> source_;
  Grid<int> source_piece_;
  Grid<int> source_entry_;
  std::vector<Cell> changed_sources_;
  std::vector<Cell> moved_;  // cells whose state or passability changed since the last cast
  Grid<std::uint8_t> mark_;
  Grid<float> best_;
  int cells_cast_ = 0;
};

}  // namespace prospect
