// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "engine/planner/candidate.h"
#include "engine/planner/candidate_evaluation.h"
#include "engine/problem/solver.h"
#include "engine/problem/stop_condition.h"

namespace prospect {

/// How a solver is called on the best candidates of a step.
struct PolishOptions {
  int polished = 2;        ///< candidates handed to the solver
  int evaluations = 24;    ///< cost evaluations each
  Options solver_options;  ///< passed to the solver besides; they stand above what follows here
  bool shares_threads = false;  ///< the solver compares starts and takes the option `threads`
};

/// Whether one solve of all starts takes the option `threads`.
bool shares_threads(const Solver& solver);

/// What the solves of a step came to.
struct PolishOutcome {
  Counters counters;                         ///< of all solves
  StopReason stop = StopReason::kConverged;  ///< of the last one
  std::string error;                         ///< detail of the last one that ended in kError
};

/// Polishes the best candidates and puts the results among the others.
///
/// A solver that compares starts is called once, with all candidates and the evaluations of all
/// polishes; any other once for each of the best `polished` candidates that end in basins apart
/// (0.4 m or 0.5 rad), side by side on the workers. Results are made admissible and evaluated
/// again: what is compared is what would be driven, whatever the solver says of it. So are the
/// scored candidates that may be better than all that are known exactly. A solver that throws, or
/// whose result is no point of the problem, adds nothing.
///
/// candidates: scored, best first; afterwards best first, the order of what comes first that of
/// exact costs. Once `stop` asks to stop nothing more is evaluated: what was only scored then
/// stands where its score puts it. stop: asked from one thread at a time.
PolishOutcome polish(std::vector<Candidate>& candidates, const Solver& solver,
                     const PolishOptions& options, const CandidateEvaluation& evaluation,
                     const StopCondition& stop);

}  // namespace prospect
