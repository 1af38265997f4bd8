// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "engine/behaviour/safety_level.h"
#include "engine/maps/belief.h"
#include "engine/maps/surface_drift.h"
#include "engine/planner/candidate.h"
#include "engine/planner/plan_certifier.h"
#include "engine/problem/problem.h"
#include "engine/problem/stop_condition.h"
#include "engine/safety/plan.h"
#include "engine/terms/visible_features.h"

namespace prospect {

/// What the candidates of a step are checked against.
struct ChoiceContext {
  const Belief& belief;
  const Problem& problem;
  const PlanCertifier& certifier;
  SafetyLevel safety_level;
  const SurfaceDrift& drift;
  const VisibleFeatures& visible_features;  ///< says Plan::visible
  int committed;  ///< leading stages to certify, with the stop after them, 1 to N
  /// Once it asks to stop, no further candidate is tried but one that stops.
  const StopCondition& stop;
};

/// Fills the plan with the first candidate, in the order given, that the exact certificate allows,
/// and its Plan::candidates with what became of them. Ten are tried, and those that stop whatever
/// their rank. Returns false, with Plan::certificate the first refusal, if none is certified: then
/// the plan has no commands. Passes on what a term throws.
bool choose_certified(const std::vector<Candidate>& candidates, const ChoiceContext& context,
                      Plan& plan);

}  // namespace prospect
