// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "benchmarks/dynamic_window.h"
#include "benchmarks/frontier_rule.h"
#include "engine/planner/planner.h"
#include "engine/planner/replanner.h"

namespace prospect {

/// A classical frontier planner to measure Planner against: choose one frontier by a rule, drive to
/// the best viewpoint of it, turn towards it, choose the next when it is resolved.
///
/// Of the planner it shares everything but the objective and the optimiser: model and rate limits,
/// frontiers, viewpoints, memory of failed observations, watchdog and cost-to-go
/// (SingleFrontierPlanner), hard and desired clearance, certificate, policy on unknown space,
/// stopping tail. It drives by a dynamic window (dynamic_window()). It knows nothing of features,
/// and does not retreat to them when localization degrades: Planner's retreat made both rules
/// slower in the office and on stage/simple_rooms (one seed each), so the frontier planners are
/// measured without it.
///
/// plan() never throws and always returns an executable plan, as Planner. Deterministic.
/// Thread-safety: one thread a planner.
class BaselinePlanner final : public Replanner {
 public:
  /// Of `parameters`, what is not said above has no effect. Throws std::invalid_argument naming the
  /// parameter, its value and what was expected.
  BaselinePlanner(FrontierRule rule, RobotDescription robot, PlannerParameters parameters);
  ~BaselinePlanner() override;
  BaselinePlanner(const BaselinePlanner&) = delete;
  BaselinePlanner& operator=(const BaselinePlanner&) = delete;

  Plan plan(const Belief& belief) override;
  std::shared_ptr<const GlobalPlan> global_plan() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Parameters that leave Planner only the choice of the nearest frontier: the cost-to-go has no
/// bonus for size and a head start that no other frontier can make up, so it leads to the nearest
/// until that is resolved; gain counts at that frontier alone; features have no weight. The rest
/// (horizon, weights, solver, certificate, retreats) stays: what is left of the difference to
/// BaselinePlanner with kNearest is the driver, and to Planner the objective.
PlannerParameters nearest_frontier_parameters(PlannerParameters parameters);

}  // namespace prospect
