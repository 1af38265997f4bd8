#include "solvers/solver_frame.h"

#include <exception>

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

Result SolverFrame::solve_with(Evaluator& evaluator, const OptionSet& set,
                               const WarmStart& warm_start) const {
  WarmStart next;
  next.time = warm_start.time;
  try {
    Eigen::VectorXd start;
    const Outcome outcome = evaluator.evaluate_start(warm_start, start_evaluation(), start);
    if (outcome != Outcome::kEvaluated) {
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

Result SolverFrame::solve(const Problem& problem, const WarmStart& warm_start,
                          const Options& options, const StopCondition& stop) const {
  try {
    OptionSet set = read(options);
    const std::string refusal = explain_refusal(problem, set);
    if (!refusal.empty()) return failed_result(problem, refusal);
    Evaluator evaluator(problem, set.common(), stop);
    return solve_with(evaluator, set, warm_start);
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

std::vector<std::optional<Result>> SolverFrame::solve_within(
    Evaluator& outer, const std::vector<WarmStart>& starts, const Options& options,
    StopCondition::Clock::time_point latest) const {
  std::vector<std::optional<Result>> results(starts.size());
  OptionSet set = read(options);
  const std::string refusal = explain_refusal(outer.problem(), set);
  if (!refusal.empty()) {
    for (auto& result : results) result = failed_result(outer.problem(), refusal);
    return results;
  }
  outer.run_beside(static_cast<int>(starts.size()), set.common(), [&](int k, Evaluator& evaluator) {
    if (k > 0 && StopCondition::Clock::now() >= latest) return;
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
