// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "engine/planner/planner.h"
#include "engine/planner/seeds.h"
#include "engine/safety/plan.h"
#include "engine/terms/problem_specification.h"

namespace prospect {

/// A term of PlannerParameters::terms that a step had to do without.
struct FailedTerm {
  std::string name;
  std::string why;  ///< "term 'x': what is wrong"
};

/// Throws std::invalid_argument for a use that no registry made: no entry, a built-in one, a weight
/// that is not above 0 and at most TermEntry::kMostWeight, or an option that is missing.
void check_added_term(const TermUse& use);

/// Makes the added terms of a specification, and takes those that cannot be made out of it: what
/// one term from outside does must not stop a robot. Never throws for what a factory does.
std::vector<FailedTerm> make_added_terms(ProblemSpecification& specification,
                                         CachedEvaluators& evaluators);

/// Evaluates each added term by itself at the seeds, and takes those out of the specification whose
/// value is a finite number at none of them, whose gradient is none at the first one where the
/// value is, or that throw. Where it returns any, the problem is to be assembled again. Never
/// throws for what a term does.
std::vector<FailedTerm> try_added_terms(ProblemSpecification& specification,
                                        CachedEvaluators& evaluators,
                                        const std::vector<Seed>& seeds);

/// Says so in the plan's `detail` and `why`, and gives each a value that is not a number in its
/// explanation.
void tell(const std::vector<FailedTerm>& failed, Plan& plan);

}  // namespace prospect
