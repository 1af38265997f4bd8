// SPDX-License-Identifier: Apache-2.0
#include "solvers/solver_frame.h"

#include <exception>

#include "solvers/judged_rounds.h"

namespace prospect {

OptionSet SolverFrame::read(const Options& options) const {
  std::vector<OptionInfo> known = this->options();
  const std::vector<OptionInfo> further = further_options();
  known.insert(known.end(), further.begin(), further.end());
  return OptionSet(known, options);
}

std::string SolverFrame::explain_refusal(const Problem& problem, OptionSet& set) const {
  if (set.error().empty()) check_options(set);
  const std::string why = set.error().empty() ? explain_unsupported(problem) : set.error();
  return why.empty() ? why : name() + ": " + why;
}

Result SolverFrame::solve_from(Evaluator& evaluator, const OptionSet& set,
                               const WarmStart& warm_start, EvaluationOutcome outcome,
                               const Eigen::VectorXd& start) const {
  WarmStart next;
  next.time = warm_start.time;
  try {
    if (outcome != EvaluationOutcome::kEvaluated) {
      return evaluator.finish(StopReason::kNumericalTrouble, false, "", next);
    }
    if (evaluator.num_variables() == 0) {
      return evaluator.finish(StopReason::kConverged, true, "every variable is fixed", next);
    }
    return run(evaluator, set, warm_start, start);
  } catch (const std::exception& e) {
    evaluator.fail(name() + ": " + e.what());
  } catch (...) {
    evaluator.fail(name() + ": an exception that is not a std::exception");
  }
  return evaluator.finish(StopReason::kError, false, "", next);
}

Result SolverFrame::solve_with(Evaluator& evaluator, const OptionSet& set,
                               const WarmStart& warm_start) const {
  Eigen::VectorXd start;
  const EvaluationOutcome outcome = evaluator.evaluate_start(warm_start, start_evaluation(), start);
  return solve_from(evaluator, set, warm_start, outcome, start);
}

Result SolverFrame::solve_scaled(const Problem& problem, const ProblemScale& scale,
                                 const OptionSet& set, const CommonOptions& common,
                                 const WarmStart& warm_start, const StopCondition& stop) const {
  if (scale.plain()) {
    Evaluator evaluator(problem, common, stop);
    return solve_with(evaluator, set, warm_start);
  }
  const Problem rescaled = scale.apply(problem);
  Evaluator evaluator(rescaled, common, stop);
  Result result = solve_with(evaluator, set, scale.apply(warm_start));
  scale.undo(problem, result);
  return result;
}

Result SolverFrame::solve_in_rounds(const Problem& problem, const OptionSet& set,
                                    const WarmStart& warm_start, const StopCondition& stop) const {
  const double begin = seconds_by(stop.clock());
  Evaluator first(problem, set.common(), stop);
  // Of the first evaluator: what judges lies beside what is solved.
  const EvaluatePoint evaluate = first.uncounted();
  Eigen::VectorXd start;
  const EvaluationOutcome outcome = first.evaluate_start(warm_start, start_evaluation(), start);
  ProblemScale scale;
  if (outcome == EvaluationOutcome::kEvaluated &&
      !looks_plain(problem, first.expand(start), first.last_evaluation())) {
    scale = scale_near(problem, first.expand(start), evaluate);
  }
  JudgedRounds rounds(problem, set.common(), evaluate);
  Result result;
  if (scale.plain()) {
    result = solve_from(first, set, warm_start, outcome, start);
  } else {
    // The start is evaluated again, and counts once.
    Counters before = first.counters();
    --before.cost_evaluations;
    if (before.gradient_evaluations > 0) --before.gradient_evaluations;
    rounds.count(before);
    WarmStart from = warm_start;
    from.x = first.expand(start);
    result = solve_scaled(problem, scale, set, rounds.options(), from, stop);
  }
  while (rounds.judge(scale, result)) {
    WarmStart from = warm_start;
    from.x = rounds.next_start();
    scale = rounds.next_scale();
    result = solve_scaled(problem, scale, set, rounds.options(), from, stop);
  }
  if (!first.error().empty()) {  // of the judge, if the round did not end with it
    result.stop = StopReason::kError;
    result.detail = first.error();
    if (result.quality == Quality::kFeasibleOptimum) result.quality = Quality::kFeasible;
  }
  result.seconds = seconds_by(stop.clock()) - begin;
  return result;
}

Result SolverFrame::solve(const Problem& problem, const WarmStart& warm_start,
                          const Options& options, const StopCondition& stop) const {
  try {
    OptionSet set = read(options);
    const std::string refusal = explain_refusal(problem, set);
    if (!refusal.empty()) return failed_result(problem, refusal);
    return solve_in_rounds(problem, set, warm_start, stop);
  } catch (const std::exception& e) {
    return failed_result(problem, name() + ": " + e.what());
  } catch (...) {
    return failed_result(problem, name() + ": an exception that is not a std::exception");
  }
}

Result SolverFrame::solve_within(Evaluator& outer, const WarmStart& warm_start,
                                 const Options& options) const {
  OptionSet set = read(options);
  const std::string refusal = explain_refusal(outer.problem(), set);
  if (!refusal.empty()) return failed_result(outer.problem(), refusal);
  Evaluator evaluator(outer, set.common());
  return solve_with(evaluator, set, warm_start);
}

std::vector<std::optional<Result>> SolverFrame::solve_within(Evaluator& outer,
                                                             const std::vector<WarmStart>& starts,
                                                             const Options& options) const {
  std::vector<std::optional<Result>> results(starts.size());
  OptionSet set = read(options);
  const std::string refusal = explain_refusal(outer.problem(), set);
  if (!refusal.empty()) {
    for (auto& result : results) result = failed_result(outer.problem(), refusal);
    return results;
  }
  outer.run_beside(static_cast<int>(starts.size()), set.common(), [&](int k, Evaluator& evaluator) {
    if (k > 0 && outer.seconds_left() <= 0.0) return;
    const auto at = static_cast<std::size_t>(k);
    results[at] = solve_with(evaluator, set, starts[at]);
  });
  return results;
}

std::string explain_no_gradient(const Problem& problem) {
  for (const auto& [term, weight] : problem.definition().terms) {
    const TermTraits traits = term->traits();
    if (!traits.has_gradient) {
      return "term '" + std::string(term->name()) +
             "' has no gradient; a back end without derivatives can take this problem";
    }
    if (traits.smoothness == Smoothness::kDiscontinuous) {
      return "term '" + std::string(term->name()) +
             "' is discontinuous; a back end without derivatives can take this problem";
    }
  }
  return {};
}

}  // namespace prospect
