#include "engine/planner/global_planner.h"

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
    : frontier_planner_(parameters.frontier_planner) {
  if (parameters.frontier_planner.cost_to_go.lambda > 0.0 && parameters.w_l > 0.0) {
    FeatureVisibilityMapOptions options;
    options.attenuation = parameters.feature_attenuation;
    visibility_map_.emplace(options, robot, parameters.visibility);
  }
}

void GlobalPlanner::restart(const FrontierPlannerOptions& options) {
  frontier_planner_ = FrontierPlanner(options);
  goal_planner_.reset();
}

std::optional<Goal> GlobalPlanner::goal() const {
  return goal_planner_ ? std::optional(goal_planner_->goal()) : std::nullopt;
}

const Traversability& GlobalPlanner::traversability() const {
  return goal_planner_ ? goal_planner_->traversability() : frontier_planner_.traversability();
}

std::shared_ptr<const GlobalPlan> GlobalPlanner::update(const Belief& belief,
                                                        const PlannerParameters& parameters,
                                                        double frontier_stamp,
                                                        const FrontierAttention& attention,
                                                        const LocalTexture* texture,
                                                        WorkerThreads& workers, Facts& facts) {
  if (!start_) start_ = belief.pose;
  std::shared_ptr<const GlobalPlan> global_plan;
  if (parameters.task.kind == TaskKind::kExplore) {
    global_plan = explore(belief, parameters, frontier_stamp, attention, texture, workers);
    facts.frontiers = global_plan->facts;
  } else if (has_goal(parameters.task.kind)) {
    global_plan = go(belief, parameters, attention);
    facts.goal = goal_planner_->facts();
  } else {
    global_plan = stay(belief);
  }
  return global_plan;
}

std::shared_ptr<const GlobalPlan> GlobalPlanner::explore(
    const Belief& belief, const PlannerParameters& parameters, double frontier_stamp,
    const FrontierAttention& attention, const LocalTexture* texture, WorkerThreads& workers) {
  // Without a landmark all ways are alike.
  const bool looks_out = visibility_map_ && !belief.landmarks->landmarks.empty();
  if (looks_out) {
    visibility_map_->update(belief,
                            parameters.feature_prior ? belief.landmarks->feature_density : 0.0,
                            texture, &workers);
  }
  return frontier_planner_.update(*belief.ground, belief.pose, frontier_stamp, attention,
                                  looks_out ? &*visibility_map_ : nullptr);
}

std::shared_ptr<const GlobalPlan> GlobalPlanner::go(const Belief& belief,
                                                    const PlannerParameters& parameters,
                                                    const FrontierAttention& attention) {
  if (!goal_planner_) {
    const bool back = parameters.task.kind == TaskKind::kReturn;
    Goal goal = parameters.task.goal;
    if (back) {
      goal.position = start_->position.head<2>();
      goal.yaw = start_->yaw;
    }
    goal_planner_.emplace(GoalPlannerOptions{parameters.frontier_planner.traversability,
                                             parameters.frontier_planner.cost_to_go},
                          goal,
                          back ? parameters.return_unknown_price : parameters.goal_unknown_price);
  }
  return goal_planner_->update(*belief.ground, belief.pose, belief.stamp, attention.pursued,
                               attention.blocked);
}

}  // namespace prospect
