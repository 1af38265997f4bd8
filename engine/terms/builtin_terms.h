#pragma once

#include <vector>

#include "engine/problem/problem.h"
#include "engine/problem/term_registry.h"

namespace prospect {

/// A registry with the terms of the planner's problem (formulation, section 7), in the order in
/// which a problem has them. Their options are none: what they are made of are settings of the
/// planner that other parts of it share.
TermRegistry builtin_terms();

/// Those of the specification, with its weights: all that apply to it and that it does not leave
/// out. Throws std::invalid_argument as the terms' constructors do.
std::vector<ProblemDefinition::WeightedTerm> make_builtin_terms(const TermContext& context);

}  // namespace prospect
