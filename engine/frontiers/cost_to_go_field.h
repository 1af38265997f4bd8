// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/frontiers/area_sources.h"
#include "engine/frontiers/cost_to_go.h"
#include "engine/frontiers/frontiers.h"
#include "engine/frontiers/goal_sources.h"
#include "engine/maps/grid.h"
#include "engine/maps/traversability.h"

namespace prospect {

class Knobs;

struct CostToGoOptions {
  double v_max = 0.6;               ///< [m/s]
  double stop_beyond = 5.0;         ///< [m] flooding stops this far beyond the robot's value
  double fill_slope = 3.0;          ///< [m/m] rise into cells that were not reached
  double window_radius = 6.0;       ///< [m] half side of the window around the robot
  double lambda = 3.0;              ///< price of paths on which no feature is seen, 0: none
  double features_required = 60.0;  ///< N_req

  /// lambda max(0, 1 - N / N_req): what a path costs more per metre on which N features are in
  /// view.
  double localization_price(double count) const {
    return lambda * std::max(0.0, 1.0 - count / features_required);
  }
};

/// The knobs (models/knobs.h); v_max and features_required are the planner's.
void describe(Knobs& knobs, CostToGoOptions& options);

/// Solves for the cost-to-go D(c) = min over viewpoints of [source + path cost] on the whole map
/// and keeps it from one map to the next.
///
///   |grad D| = f,  f(c) = factor(c) (1 + lambda max(0, 1 - N(c) / N_req)),  D <= source at
///   viewpoints
///
/// by the first-order upwind discretisation of the eikonal equation (fast marching) over passable
/// cells: D(c) = min(source(c), F(a, b)), a, b the smaller of the neighbours along x and along y,
///   F = (a + b + sqrt(2 (r f)^2 - (a - b)^2)) / 2 if |a - b| < r f, else min(a, b) + r f.
/// It overestimates. In open space, d cells from a point source, the error against the Euclidean
/// distance is between 0 and r (0.25 + 0.25 ln d), under 3.5 % beyond 30 cells (tested); it has no
/// preferred axes, so its gradient points the right way, unlike that of an 8- or 16-neighbour
/// search (up to 22 or 13 degrees off).
///
/// F depends only on neighbours that are strictly lower, so the equations have one solution, and
/// the order in which they are solved does not matter: update() repairs and solve_from_scratch()
/// give the same bits. Repair: cells whose equation changed and that lost their support are
/// invalidated, and with them whatever they supported, in turn; then the front marches again from
/// the rim of what is left. Marching stops when everything up to D(robot) + stop_beyond is settled;
/// the rest of the front is kept for the next update.
///
/// Value type. Thread-safety: none while updating. Does not allocate once buffers have grown,
/// except for the window handed out. Source: formulation, section 6; discretisation and repair are
/// our choice.
class CostToGoField {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit CostToGoField(const CostToGoOptions& options);

  /// Repairs the field after traversability.update() and frontiers.set_goal() of the same step.
  /// features: expected count N of visible features by cell (any frame; beyond it ways cost nothing
  /// more), null: no localization weighting. robot: its cell. Cost: that of what changed, and of
  /// the cells in `features`.
  void update(const Traversability& traversability, const FrontierDetector& frontiers, Cell robot,
              const Grid<float>* features = nullptr, const PausePoint& pause = {});
  /// The same from nothing, and from other sources than viewpoints. After sources of the one kind
  /// have been used, those of the other need the field anew.
  void solve_from_scratch(const Traversability& traversability, const FrontierDetector& frontiers,
                          Cell robot, const Grid<float>* features = nullptr);

  void update(const Traversability& traversability, const GoalSources& goal, Cell robot,
              const PausePoint& pause = {});
  void solve_from_scratch(const Traversability& traversability, const GoalSources& goal, Cell robot,
                          const PausePoint& pause = {});
  void solve_from_scratch(const Traversability& traversability, const AreaSources& area, Cell robot,
                          const PausePoint& pause = {});

  /// D [m of path equivalent]; +infinity where not reached or beyond the stopping value.
  double value(Cell c) const;
  /// The one of the eight neighbours at which D is lowest; c itself if it is nowhere lower.
  Cell downhill(Cell c) const;
  /// Largest value to which the field is settled [m]; +infinity if all of it is.
  double settled() const { return settled_; }
  /// The passable cell nearest to the robot, within 1 m, for which reachability is judged; the
  /// robot's own if there is none.
  Cell anchor() const { return anchor_; }
  bool anchor_reached() const;
  /// The source that the anchor's way down ends at; requires anchor_reached().
  Cell source_of_anchor() const;

  /// The window around the robot, filled outward: V_ij = D / v_max where reached, else the value of
  /// the nearest reached cell + fill_slope x distance (from the nearest, so that it rises away from
  /// either side of a wall). All zero where nothing was reached in the window.
  std::shared_ptr<const CostToGo> window() const;

  /// Cell evaluations of the last update, for measuring.
  std::int64_t evaluations() const { return evaluations_; }
  const CostToGoOptions& options() const { return options_; }

 private:
  void relayout(const Traversability& traversability, const PausePoint& pause);
  template <typename Sources>
  void refresh(int index, Cell c, const Traversability& traversability, const Sources& sources,
               const Grid<float>* features);
  template <typename Sources>
  void update_from(const Traversability& traversability, const Sources& sources, Cell robot,
                   const Grid<float>* features, const PausePoint& pause);
  double solve_cell(int index) const;
  void to_front(int index);
  void push(int index, double key);
  void invalidate(int index);
  void repair_support(const PausePoint& pause);
  void march(const PausePoint& pause);
  void find_anchor(const Traversability& traversability, bool reached_only);
  bool reached(int index) const;

  CostToGoOptions options_;
  GridFrame frame_;              // Traversability::frame(): its outermost cells are impassable
  std::vector<double> d_;        // D [m], infinity: not reached
  std::vector<float> slowness_;  // r f [m]; 0: impassable
  std::vector<float> source_;    // [m], infinity: none
  std::vector<std::uint8_t> in_front_;
  std::vector<int> front_;  // cells to be solved again
  std::vector<double> front_keys_;
  std::vector<int> touched_;         // cells whose equation changed
  std::vector<int> raised_;          // cells invalidated whose neighbours are not yet checked
  std::vector<int> pending_bucket_;  // by cell: bucket of its live entry, -1 none
  struct Entry {
    int cell;
    int next;
  };
  std::vector<Entry> entries_;
  std::vector<int> bucket_head_;
  double key_base_ = 0.0, key_width_ = 0.05;
  int bucket_ = 0;
  Cell robot_, anchor_;
  double settled_ = 0.0;
  GridFrame priced_{0.0, 0, 0, 0, 0};  // of the features of the last update
  bool fresh_ = true;
  std::int64_t evaluations_ = 0;
};

}  // namespace prospect
