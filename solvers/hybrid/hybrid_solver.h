#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "engine/problem/solver.h"

namespace prospect {

/// Many starts, few of them polished: for problems with several basins, where the start matters
/// more than the method. A solve goes
///
///  1. Seeds: warm_start.x and the columns of warm_start.seeds, and a spread of its own
///     (spread_candidates.h) up to `candidates`; by default only where none are given. They keep
///     bounds and rate limits, and take half of the evaluations at most.
///  2. All are scored in one batch and ranked: feasible first, then by cost, else by violation.
///     Under a deadline, given seeds are scored in their order for a sixteenth of the time only
///     (StopCondition::latest()), eight at least.
///  3. Down the ranking, a seed opens a basin unless it is near one already open,
///       |z - z'|^2 / n + ((J - J') / (J_median - J_best))^2 < separation^2,
///     z normalised by the ranges of the variables, until `basins` are open, or as many as can have
///     their first round with half of what is left: of the evaluations, and of the time, if the
///     stop condition says when it strikes (an evaluation with its gradient is taken for three
///     times the time of a score; `threads` share the basins, if one had time for two).
///  4. In rounds, every open basin is polished by the back end `polish` to a loose tolerance, best
///     first and as many at a time as there are `threads` (Evaluator::run_beside), and the better
///     half of what they came to stays open; those that came to the same point count once. The
///     first round gives each `polish_evaluations`, every other twice as many as the one before,
///     but no round more than half of what is left. Shares are counted in evaluations, so that
///     results do not depend on the clock; where the stop condition says when it strikes
///     (StopCondition::latest()), a round that has used up half of that time polishes no further
///     basin but the best, so a solve under a deadline may differ though it did not strike.
///  5. The incumbent is polished until `polish` calls it converged or the budget is used up.
///
/// The incumbent is the best of everything evaluated, whoever evaluated it. Nothing is drawn at
/// random. Takes problems that its polish takes: with gradients. Why it stopped, and whether the
/// incumbent is an optimum (a local one), are those of step 5.
///
/// Source: multistart with clustering of starts, Rinnooy Kan and Timmer (1987); halving of the
/// field, Karnin et al. (2013); the distance and the shares are our choice.
///
/// `polish` is looked up by `find`, which throws std::invalid_argument for unknown names. Its
/// fallback "auto" is `unconstrained` for problems without constraints and `constrained` for
/// others.
struct HybridPolish {
  std::function<std::shared_ptr<const Solver>(std::string_view name)> find;
  std::string unconstrained, constrained;
};

std::shared_ptr<const Solver> make_hybrid_solver(std::string name, HybridPolish polish);

}  // namespace prospect
