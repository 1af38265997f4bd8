// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/global_planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/frontiers/known_paths.h"
#include "engine/task/task.h"

namespace prospect {
namespace {

/// Nowhere to go: the robot stays.
std::shared_ptr<const GlobalPlan> stay(const Belief& belief) {
  auto nothing = std::make_shared<GlobalPlan>();
  const double r = belief.ground->frame().resolution;
  nothing->map_revision = belief.ground->revision();
  nothing->stamp = belief.stamp;
  nothing->cost_to_go = std::make_shared<const CostToGo>();
  nothing->explored_area = r * r * (belief.ground->free_cells() + belief.ground->occupied_cells());
  return nothing;
}

}  // namespace

GlobalPlanner::GlobalPlanner(const RobotDescription& robot, const PlannerParameters& parameters)
    : frontier_planner_(parameters.frontier_planner),
      known_(parameters.frontier_planner.traversability),
      task_(parameters.task) {
  if (parameters.frontier_planner.cost_to_go.lambda > 0.0 &&
      parameters.weights.visible_features > 0.0) {
    FeatureVisibilityMapOptions options;
    options.attenuation = parameters.feature_attenuation;
    visibility_map_.emplace(options, robot, parameters.visibility);
  }
}

void GlobalPlanner::restart(const FrontierPlannerOptions& options) {
  frontier_planner_ = FrontierPlanner(options);
  known_ = options.traversability;
  area_planner_.reset();
  exhaustion_ = {};
  goal_planner_.reset();
}

void GlobalPlanner::follow(const FrontierPlannerOptions& options, const Task& task) {
  task_ = task;
  const std::shared_ptr<const ZoneMap>& zones = options.traversability.zones;
  frontier_planner_.follow(options);
  known_.zones = zones;
  if (area_planner_) area_planner_->follow(zones, {}, options.area);
  if (!goal_planner_) return;
  // The place to return to was measured.
  Goal goal = goal_planner_->goal();
  if (task.kind == TaskKind::kGoTo) goal = task.goal;
  goal_planner_->follow(zones, goal, std::nullopt);
}

void GlobalPlanner::follow(const PlaceMoves& moves) {
  frontier_planner_.follow(moves);
  if (start_) start_ = moves.now(*start_);
  if (area_planner_) area_planner_->follow(moves);
  if (goal_planner_) goal_planner_->follow(moves);
  if (!goal_planner_ || task_.kind != TaskKind::kReturn) return;
  Goal goal = goal_planner_->goal();
  goal.position = start_->position.head<2>();
  goal.yaw = start_->yaw;
  goal_planner_->follow(known_.zones, goal, std::nullopt);
}

std::optional<Goal> GlobalPlanner::goal() const {
  return goal_planner_ ? std::optional(goal_planner_->goal()) : std::nullopt;
}

const Traversability& GlobalPlanner::traversability() const {
  return goal_planner_ ? goal_planner_->traversability() : frontier_planner_.traversability();
}

WholeMap GlobalPlanner::update(const Belief& belief, const PlannerParameters& parameters,
                               double frontier_stamp, const FrontierActivity& activity,
                               const LocalTexture* texture, WorkerThreads& workers,
                               const PausePoint& pause) {
  if (!start_) start_ = belief.pose;
  WholeMap whole;
  if (task_.kind == TaskKind::kExplore) {
    whole.global_plan =
        explore(belief, parameters, frontier_stamp, activity, texture, workers, pause);
    whole.frontiers = whole.global_plan->facts;
  } else if (has_goal(task_.kind)) {
    whole.global_plan = go(belief, parameters, activity, pause);
    whole.goal = goal_planner_->facts();
  } else {
    whole.global_plan = stay(belief);
  }
  return whole;
}

std::shared_ptr<const GlobalPlan> GlobalPlanner::explore(
    const Belief& belief, const PlannerParameters& parameters, double frontier_stamp,
    const FrontierActivity& activity, const LocalTexture* texture, WorkerThreads& workers,
    const PausePoint& pause) {
  // Without a landmark all ways are alike.
  const bool predicts_view = visibility_map_ && !belief.landmarks->landmarks.empty();
  if (predicts_view) {
    visibility_map_->update(belief,
                            parameters.feature_prior ? belief.landmarks->feature_density : 0.0,
                            texture, &workers, pause);
  }
  auto plan = frontier_planner_.update(*belief.ground, belief.pose, frontier_stamp, activity,
                                       predicts_view ? &*visibility_map_ : nullptr, pause);
  if (!task_.area) return plan;
  return set_goal_area(std::move(plan), belief, parameters, frontier_stamp, activity, pause);
}

std::shared_ptr<const GlobalPlan> GlobalPlanner::set_goal_area(
    std::shared_ptr<const GlobalPlan> frontiers, const Belief& belief,
    const PlannerParameters& parameters, double frontier_stamp, const FrontierActivity& activity,
    const PausePoint& pause) {
  if (!frontiers->facts.exhausted) {
    exhaustion_.update(frontier_stamp, {false, activity.pursued});
    if (area_planner_) area_planner_->resume();
    return frontiers;
  }
  if (!area_planner_) {
    area_planner_.emplace(GoalPlannerOptions{parameters.frontier_planner.traversability,
                                             parameters.frontier_planner.cost_to_go},
                          *task_.area, parameters.goal_unknown_price);
  }
  const auto path =
      area_planner_->update(*belief.ground, belief.pose, frontier_stamp, activity, pause);
  const GoalFacts& goal = area_planner_->facts();
  auto plan = std::make_shared<GlobalPlan>(path->target ? *path : *frontiers);
  FrontierFacts& facts = plan->facts;
  facts.explored_area = frontiers->facts.explored_area;
  facts.exhausted = !path->target;
  facts.exhausted_for = exhaustion_.update(frontier_stamp, {facts.exhausted, activity.pursued});
  facts.area_unseen = facts.exhausted && !(area_planner_->seen() > 0.0);
  facts.area_why = goal.why;
  if (path->target) {
    facts.to_area = true;
    facts.unknown_left = goal.unknown_left;
    facts.stalled = goal.stalled;
    facts.stalled_for = goal.stalled_for;
  }
  plan->milliseconds += path->target ? frontiers->milliseconds : path->milliseconds;
  return plan;
}

std::optional<ReturnPath> GlobalPlanner::return_path(const Belief& belief,
                                                     const MotionModel& model) const {
  if (!start_) return std::nullopt;
  const Eigen::Vector2d from = belief.pose.position.head<2>(), to = start_->position.head<2>();
  const KnownPaths paths(*belief.ground, belief.pose, known_, to);
  const double straight = (from - to).norm();
  ReturnPath back;
  back.length = std::max(straight, paths.length_near(from));
  // What is drawn shut now was open when it came through.
  if (!std::isfinite(back.length)) back.length = 2.0 * straight;
  back.time =
      back.length / (2.0 / 3.0 * model.max_speed()) + 2.0 * M_PI / (0.5 * model.max_yaw_rate());
  return back;
}

std::shared_ptr<const GlobalPlan> GlobalPlanner::go(const Belief& belief,
                                                    const PlannerParameters& parameters,
                                                    const FrontierActivity& activity,
                                                    const PausePoint& pause) {
  if (!goal_planner_) {
    const bool back = task_.kind == TaskKind::kReturn;
    Goal goal = task_.goal;
    if (back) {
      goal.position = start_->position.head<2>();
      goal.yaw = start_->yaw;
    }
    goal_planner_.emplace(GoalPlannerOptions{parameters.frontier_planner.traversability,
                                             parameters.frontier_planner.cost_to_go},
                          goal,
                          back ? parameters.return_unknown_price : parameters.goal_unknown_price);
  }
  return goal_planner_->update(*belief.ground, belief.pose, belief.stamp, activity, pause);
}

}  // namespace prospect
