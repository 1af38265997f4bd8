// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "engine/planner/candidate.h"
#include "engine/problem/problem.h"
#include "engine/problem/stop_condition.h"
#include "engine/support/worker_threads.h"

namespace prospect {

/// How the candidates of one step are evaluated. What it points to outlives it.
struct CandidateEvaluation {
  const Problem& problem;
  const Term* visible_features;  ///< the term that fills Candidate::features; null: none
  int threads;                   ///< that share the work; the same bits for any number
  WorkerThreads& workers;
};

/// Those candidates that can be evaluated, with their costs, best first (Candidate::operator<,
/// equal ones in the order given). Scores choose among seeds, the exact value tells what a plan
/// costs: where a score cannot be evaluated in single precision, all values are exact. Once a
/// deadline in `stop` has passed, only the first two are evaluated, and those that have been
/// begun; the rest are left out. Passes on what a term throws. Thread-safety: that of the workers.
std::vector<Candidate> evaluate(std::vector<Candidate> candidates, Evaluate what,
                                const CandidateEvaluation& with, const StopCondition& stop = {});

}  // namespace prospect
