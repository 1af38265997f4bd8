// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "engine/behaviour/mode_policy.h"
#include "engine/behaviour/safety_level.h"
#include "engine/frontiers/cost_to_go.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/belief.h"
#include "engine/maps/surface_drift.h"
#include "engine/planner/planner.h"
#include "engine/planner/step_landmarks.h"
#include "engine/task/zone_map.h"
#include "engine/terms/problem_specification.h"

namespace prospect {

/// All that a step's problem depends on. The belief has its maps but for the landmarks.
struct StepContext {
  const RobotDescription& robot;
  const PlannerParameters& parameters;
  const Belief& belief;
  const GlobalPlan& global_plan;
  const FrontierPlanner& frontiers;         ///< says which targets count
  std::shared_ptr<const ZoneMap> zones;     ///< null: none
  ModeKind mode;                            ///< whose policy the problem follows
  std::shared_ptr<const CostToGo> retreat;  ///< instead of the global plan's; null: that one
  SafetyLevel safety_level;
  const SurfaceDrift& drift;
  const StepLandmarks& landmarks;
};

/// What the problem of a step is made of.
struct StepSpecification {
  ProblemSpecification problem;
  std::size_t num_mapped;  ///< of the problem's landmarks; those after them are expected ones
};

/// From belief, global plan, mode and safety level to the problem's specification, group by group:
/// robot and horizon, obstacles, visible features, exploration, cost-to-go, weights. Deterministic.
/// Passes on what the maps throw. Thread-safety: pure.
StepSpecification specify_problem(const StepContext& context);

}  // namespace prospect
