// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "engine/problem/solver.h"

namespace prospect {

/// The back end of a name; throws std::invalid_argument for unknown ones.
using FindSolver = std::function<std::shared_ptr<const Solver>(std::string_view name)>;

/// Many starts, few of them polished: for problems with several basins, where the start matters
/// more than the method. A solve goes
///
///  1. Seeds: warm_start.x and the columns of warm_start.seeds, and a spread of its own
///     (spread_candidates.h) up to `candidates`; by default only where none are given. They keep
///     bounds and rate limits, and take half of the evaluations at most.
///  2. All are scored in one batch and ranked: feasible first, then by cost, else by violation.
///     Under a deadline, given seeds are scored in their order for a sixteenth of the time only
///     (StopCondition::left()), eight at least. Down the ranking, a seed is a start unless it is
///     near a better one that is,
///       |z - z'|^2 / n + ((J - J') / (J_median - J_best))^2 < separation^2,
///     z normalised by the ranges of the variables, until there are `basins` of them. warm_start.x
///     is the second start at the latest, whatever its score and wherever it is.
///  3. The back end `polish` polishes the best seed to the relative change of cost
///     `polish_tolerance`, with half of the evaluations left at most.
///  4. In turns, two starts are polished to the same tolerance with `polish_evaluations` at most:
///     the next seed and a neighbour of the incumbent (neighbour.h), or two neighbours once there
///     is no seed left. They begin with the second derivatives by states that the polish of the
///     incumbent ended with. A turn gains where it lowers the cost by more than `polish_tolerance`;
///     after `patience` turns in a row without gain, one more ends the search, and so does a budget
///     whose third is fewer than ten evaluations.
///  5. The incumbent is polished until `polish` calls it converged or the budget is used up.
///
/// `threads` share the scores, and the two starts of a turn (Evaluator::run_beside). Both begin at
/// the incumbent before the turn, so results have the same bits for any number of threads; no share
/// depends on the clock but that of step 2. The incumbent is the best of everything evaluated,
/// whoever evaluated it: a deadline finds it at any time. Nothing is drawn at random. Takes
/// problems that its polish takes: with gradients. Why it stopped, and whether the incumbent is an
/// optimum (a local one), are those of step 5.
///
/// Source: iterated local search, Lourenco, Martin and Stutzle (2003); multistart with clustering
/// of starts, Rinnooy Kan and Timmer (1987); distance, shares and neighbours are our choice.
///
/// `find` looks `polish` up.
std::shared_ptr<const Solver> make_hybrid_solver(std::string name, FindSolver find);

}  // namespace prospect
