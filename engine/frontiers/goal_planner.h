// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/behaviour/facts.h"
#include "engine/behaviour/monitors/goal_monitor.h"
#include "engine/behaviour/monitors/heading_monitor.h"
#include "engine/frontiers/area_sources.h"
#include "engine/frontiers/cost_to_go_field.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/frontiers/goal_sources.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/place_moves.h"
#include "engine/maps/traversability.h"
#include "engine/task/task.h"
#include "models/types.h"

namespace prospect {

struct GoalPlannerOptions {
  /// unknown_travel is replaced by the goal's price of the unknown.
  TraversabilityOptions traversability;
  CostToGoOptions cost_to_go;  ///< lambda does not count
};

/// GoalFacts::distance and reached, as of a pose; `facts` as of the step before. any_heading: that
/// of the goal cannot be had.
void judge_arrival(const Goal& goal, const Pose& pose, bool any_heading, GoalFacts& facts);

/// The path to a place, or to what is unknown of an area (area_sources.h), from one planning step
/// to the next: what the FrontierPlanner is for frontiers.
///
/// V(p) is the least cost of a path to the goal over cells that are known free, at their factor
/// (traversability.h), and unknown cells, at `unknown_price` a metre: a goal in unknown space is
/// reached by exploring towards it. What the robot may enter is decided by the certificate, as
/// ever: at the first unknown cell of the path it stops and looks, and the path is found anew over
/// what it sees. GlobalPlan::frontiers holds the unknown cells of the next kLookAhead metres of the
/// way as one frontier (none: the path is known), the target leads to where the robot looks at the
/// first of them from, or to the goal.
///
/// A robot that makes no progress for GoalMonitor::kHopelessAfter closes the place that holds it up
/// (the first unknown cell of the path, else its narrowest place within 2 m) and looks for another
/// way. Once no path is left, facts().unreachable says so, and `why` in one sentence: the goal is
/// in or too near a wall, too near a forbidden part, out of the world, no path is left, or none but
/// through a forbidden part, which is named.
///
/// A heading that cannot be had at the place (HeadingMonitor) is given up: the place counts.
///
/// A value. Thread-safety: none; what update() returns is immutable and may be shared. Never throws
/// after construction on finite input. Source: our choice; the cost-to-go is formulation, section
/// 6.
class GoalPlanner {
 public:
  static constexpr double kLookAhead = 2.0;  ///< [m]
  static constexpr double kNear = 0.6;  ///< [m] of path from which the goal is driven to itself

  /// unknown_price: 1 to 1000 metres of path equivalent a metre. Throws std::invalid_argument
  /// naming the option, its value and what was expected.
  GoalPlanner(const GoalPlannerOptions& options, const Goal& goal, double unknown_price);
  /// area: usable (polygon_fault()). It is never reached: once some of it can be looked at from
  /// what is known, that is for the FrontierPlanner.
  GoalPlanner(const GoalPlannerOptions& options, const Polygon& area, double unknown_price);

  /// ground: any map; pose finite, within 1000 km; stamp [s], non-decreasing. attention: of the
  /// time since the last update; a disc in the direction in which the robot is blocked is
  /// impassable from now on. `looked` does not count.
  std::shared_ptr<const GlobalPlan> update(const GroundMap& ground, const Pose& pose, double stamp,
                                           const FrontierActivity& activity,
                                           const PausePoint& pause = {});
  /// The same place lies elsewhere in W from the next update() on, and so do zones; an area, if it
  /// leads to one. Nothing that was learned of the ground is forgotten.
  void follow(const std::shared_ptr<const ZoneMap>& zones, const Goal& goal,
              const std::optional<Polygon>& area);
  /// Its time without progress begins anew: it had something else to do.
  void resume() { monitor_.restart(); }
  /// What was measured has moved in W.
  void follow(const PlaceMoves& moves);

  const Goal& goal() const { return goal_; }
  /// Of an area: free cells of it, times the area of a cell [m^2], at the last update.
  double seen() const { return sources_ ? sources_->seen() : 0.0; }
  const GoalFacts& facts() const { return facts_; }
  const Traversability& traversability() const { return traversability_; }

 private:
  struct Path {
    std::vector<Cell> cells;  // from the robot's to the goal's, each beside the one before
    int first_unknown = -1;   // index, -1: none
    double length = 0.0;      // [m]
    double unknown = 0.0;     // [m] of it
  };
  void solve(Cell robot, const PausePoint& pause);
  Path path() const;
  double beyond_end(const Path& path) const;
  void close_on(const Path& path);
  void update_reached(const Pose& pose, double stamp, const FrontierActivity& activity);
  std::string why_not_there() const;
  std::string why_unreachable(const GroundMap& ground, const Pose& pose,
                              const PausePoint& pause) const;
  GlobalPlan plan_along(const Path& path, const Pose& pose) const;

  GoalPlannerOptions options_;
  Goal goal_;
  std::optional<Polygon> area_;         // instead of the goal
  std::optional<AreaSources> sources_;  // of that
  Traversability traversability_;
  CostToGoField field_;
  GridFrame solved_;  // frame that the field was solved for
  GoalMonitor monitor_;
  HeadingMonitor heading_;
  GoalFacts facts_;
  std::optional<double> unreachable_since_;  // [s]
  int closed_ = 0;                           // places that held it up
};

}  // namespace prospect
