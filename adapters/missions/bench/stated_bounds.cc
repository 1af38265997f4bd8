// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/stated_bounds.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace prospect {
namespace {

// Below that no cost has a unit in which it is one: it falls on, or is no number, farther out.
constexpr double kBottomless = -1e100;

/// Whether x is near a bound that nobody stated.
bool is_held(const BenchProblem& problem, const Problem& within, const Eigen::VectorXd& x) {
  constexpr double kNear = 0.01;  // of the width
  const auto near = [&](double distance, int i) {
    return distance <= kNear * (within.upper()[i] - within.lower()[i]);
  };
  return x.size() == within.num_variables() &&
         (std::any_of(problem.no_lower.begin(), problem.no_lower.end(),
                      [&](int i) { return near(x[i] - within.lower()[i], i); }) ||
          std::any_of(problem.no_upper.begin(), problem.no_upper.end(),
                      [&](int i) { return near(within.upper()[i] - x[i], i); }));
}

}  // namespace

StatedBoundsSolve solve_within_stated_bounds(const BenchProblem& problem, const Solver& solver,
                                             const Options& given, const StopCondition& stop) {
  constexpr double kFarther[] = {1e4, 1e6, 1e8};
  constexpr int kLeastEvaluations = 10;
  const double begin = seconds_by(stop.clock());
  StatedBoundsSolve solve{solver.solve(*problem.problem, problem.start, given, stop),
                          problem.problem};
  Result& result = solve.result;
  const auto budget = given.find("max_evaluations");
  bool falls = false;
  for (const double far : kFarther) {
    solve.held = result.quality != Quality::kNone && is_held(problem, *solve.within, result.x);
    falls = false;
    if (!solve.held || result.stop == StopReason::kError || stop() != StopRequest::kNone) break;
    if (budget != given.end()) {
      if (!std::holds_alternative<int>(budget->second)) break;
      const int left = std::get<int>(budget->second) - result.counters.cost_evaluations;
      if (left < kLeastEvaluations) break;
    }
    Options rest = given;
    if (budget != given.end()) {
      rest["max_evaluations"] = std::get<int>(budget->second) - result.counters.cost_evaluations;
    }
    solve.within = problem.with_bounds(far);
    WarmStart from;
    from.x = result.x;
    const double seconds = seconds_by(stop.clock()) - begin;
    Result more = solver.solve(*solve.within, from, rest, stop);
    for (Improvement& i : more.trace) {
      i.seconds += seconds;
      i.evaluations += result.counters.cost_evaluations;
    }
    more.trace.insert(more.trace.begin(), result.trace.begin(), result.trace.end());
    more.counters.cost_evaluations += result.counters.cost_evaluations;
    more.counters.gradient_evaluations += result.counters.gradient_evaluations;
    more.counters.iterations += result.counters.iterations;
    more.seconds += seconds;
    falls = more.cost < result.cost;
    result = std::move(more);
  }
  const bool bottomless = result.cost < kBottomless;
  solve.held =
      result.quality != Quality::kNone && (bottomless || is_held(problem, *solve.within, result.x));
  if (!solve.held) return solve;
  result.detail +=
      bottomless ? ", the cost falls below any number" : ", held by a bound that nobody stated";
  if (result.quality == Quality::kFeasibleOptimum) result.quality = Quality::kFeasible;
  if ((falls || bottomless) && result.quality == Quality::kFeasible)
    result.stop = StopReason::kUnbounded;
  return solve;
}

}  // namespace prospect
