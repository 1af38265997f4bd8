// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/files/strict_yaml.h"
#include "engine/planner/planner.h"
#include "engine/problem/term_registry.h"

namespace prospect {

/// Reads `planner.terms` of the mapping `planner` into parameters that have their weights already:
///
///   terms: {my_term: {weight: 0.5, radius: 1.2}, cost_to_go: {weight: 0}}
///
/// Each entry is a term of `registry`: one that is not built in is added with these options, of a
/// built-in one the weight is set; a weight of 0 leaves either out. Records every problem: an
/// unknown term or option, a number out of its range, a weight that `planner.weights` has, too.
///
/// Returns the paths of settings whose place these take ("planner.weights.w_T"): they are not in
/// effect.
std::vector<std::string> read_terms(YamlMap planner, const TermRegistry& registry,
                                    PlannerParameters& parameters);

}  // namespace prospect
