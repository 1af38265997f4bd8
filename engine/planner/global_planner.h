// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "engine/behaviour/facts.h"
#include "engine/features/feature_visibility_map.h"
#include "engine/features/local_texture.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/frontiers/goal_planner.h"
#include "engine/maps/belief.h"
#include "engine/planner/planner.h"
#include "engine/planner/return_path.h"
#include "engine/support/worker_threads.h"

namespace prospect {

/// What a step makes of the whole map for its task.
struct WholeMap {
  std::shared_ptr<const GlobalPlan> global_plan{};
  std::optional<FrontierFacts> frontiers{};  ///< of the task to explore
  std::optional<GoalFacts> goal{};           ///< of one that leads to a place
};

/// The global plan of whatever the robot is told: towards frontiers, to a goal, back to where it
/// was first, or none. What was learned of frontiers is kept over other tasks.
///
/// Thread-safety: none; one planner each.
class GlobalPlanner {
 public:
  /// parameters.frontier_planner is complete (frontier_planner_options_for()). Throws
  /// std::invalid_argument naming the option, its value and what was expected.
  GlobalPlanner(const RobotDescription& robot, const PlannerParameters& parameters);

  /// A step with the task. frontier_stamp [s]: the belief's stamp on the clock of exploring;
  /// texture: of what is seen nearby, null where the localization does not rest on features.
  WholeMap update(const Belief& belief, const PlannerParameters& parameters, double frontier_stamp,
                  const FrontierActivity& activity, const LocalTexture* texture,
                  WorkerThreads& workers, const PausePoint& pause = {});

  /// Another task, in W, from the next step on: its path begins anew.
  void restart_task(const Task& task) {
    task_ = task;
    goal_planner_.reset();
  }
  /// What was told, zones and area in `options` and `task`, lies elsewhere in W from the next step
  /// on: what was learned stays.
  void follow(const FrontierPlannerOptions& options, const Task& task);
  /// What was measured has moved in W (correction.h), as that of the next step's belief.
  void follow(const PlaceMoves& moves);
  /// Other zones or another area: what was learned of frontiers is forgotten.
  void restart(const FrontierPlannerOptions& options);

  /// Replanner::return_path(). At two thirds of the top speed, and two half turns at half the top
  /// yaw rate: of four missions the path back took 60 to 70 % of that.
  std::optional<ReturnPath> return_path(const Belief& belief, const MotionModel& model) const;

  /// Of the task in force; none if it leads nowhere.
  std::optional<Goal> goal() const;
  /// Of the task in force.
  const Traversability& traversability() const;
  const FrontierPlanner& frontiers() const { return frontier_planner_; }

 private:
  std::shared_ptr<const GlobalPlan> explore(const Belief& belief,
                                            const PlannerParameters& parameters,
                                            double frontier_stamp, const FrontierActivity& activity,
                                            const LocalTexture* texture, WorkerThreads& workers,
                                            const PausePoint& pause);
  /// The path to what is unknown of the area, where nothing of it can be looked at from what is
  /// known.
  std::shared_ptr<const GlobalPlan> set_goal_area(std::shared_ptr<const GlobalPlan> frontiers,
                                                  const Belief& belief,
                                                  const PlannerParameters& parameters,
                                                  double frontier_stamp,
                                                  const FrontierActivity& activity,
                                                  const PausePoint& pause);
  std::shared_ptr<const GlobalPlan> go(const Belief& belief, const PlannerParameters& parameters,
                                       const FrontierActivity& activity, const PausePoint& pause);

  FrontierPlanner frontier_planner_;
  std::optional<FeatureVisibilityMap> visibility_map_;  // if the cost-to-go is weighted by it
  TraversabilityOptions known_;                         // what is passable of what is known
  std::optional<GoalPlanner> area_planner_;             // of the area that is to be explored
  ExhaustionMonitor exhaustion_;                        // of its frontiers and the paths to it
  Task task_;                                           // in W
  std::optional<GoalPlanner> goal_planner_;  // of a task that leads to a place, from its first step
  std::optional<Pose> start_;                // of the first step
};

}  // namespace prospect
