// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/landmark_map.h"
#include "engine/planner/seeds.h"
#include "engine/problem/problem.h"
#include "engine/terms/problem_specification.h"

namespace prospect {

/// A mapped landmark that a step considered.
struct ConsideredLandmark {
  Landmark landmark;
  double visibility = 0.0;  ///< probability that it is visible now
};

/// What a planning step made besides its plan. A step is a transaction: of one that ends in a plan
/// or in a certified stop all of it is there, of one that fails on the path nothing is. A value
/// that never changes; whoever observes a step holds this one.
struct PlanningStep {
  std::shared_ptr<const GlobalPlan> global_plan;              ///< frontiers and cost-to-go
  std::shared_ptr<const ProblemSpecification> specification;  ///< what the problem was made from
  std::shared_ptr<const Problem> problem;                     ///< the one that was solved
  /// Of that problem, best first: where polishing began. Those that could not be evaluated are left
  /// out.
  std::vector<Seed> seeds;
  std::vector<ConsideredLandmark> landmarks;

  bool made() const { return problem != nullptr; }
};

}  // namespace prospect
