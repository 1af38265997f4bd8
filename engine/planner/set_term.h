// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/planner/planner.h"
#include "engine/problem/term_registry.h"

namespace prospect {

/// Gives a planner's parameters a term: of a built-in one the weight, with 0 left out of the
/// problem; any other is added to the problem's terms (PlannerParameters::terms), or with weight 0
/// is not.
///
///   set_term(parameters, registry.use("keep_distance", 0.5, {{"radius", 1.0}}));
///   set_term(parameters, builtin_terms().use("cost_to_go", 0.0));
///
/// Throws std::invalid_argument if there is no entry, or if the parameters have a term of that name
/// already that is not built in.
void set_term(PlannerParameters& parameters, const TermUse& use);

}  // namespace prospect
