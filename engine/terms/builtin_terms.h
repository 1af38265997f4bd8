// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "engine/problem/problem.h"
#include "engine/problem/term_registry.h"
#include "engine/terms/problem_specification.h"

namespace prospect {

/// A registry with the terms of the planner's problem (formulation, section 7), in the order in
/// which a problem has them. Their options are none: what they are made of are settings of the
/// planner that other parts of it share.
TermRegistry builtin_terms();

/// Those of the specification, with its weights: all that apply to it and that it does not leave
/// out. Throws std::invalid_argument as the terms' constructors do.
std::vector<ProblemDefinition::WeightedTerm> make_builtin_terms(const TermContext& context);

/// That of a built-in cost among the weights; null: no built-in cost has that name.
double* weight_of(std::string_view name, ProblemSpecification::Weights& weights);

/// The factor that a built-in cost has in an objective with these weights (negative: a reward);
/// none: no built-in cost has that name.
std::optional<double> builtin_weight(std::string_view name,
                                     const ProblemSpecification::Weights& weights);

}  // namespace prospect
