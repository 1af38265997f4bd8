#include "solvers/solver_frame.h"

#include <exception>

namespace prospect {

Result SolverFrame::solve(const Problem& problem, const WarmStart& warm_start,
                          const Options& options, const StopCondition& stop) const {
  try {
    std::vector<OptionInfo> known = this->options();
    const std::vector<OptionInfo> further = further_options();
    known.insert(known.end(), further.begin(), further.end());
    OptionSet set(known, options);
    if (set.error().empty()) check_options(set);
    if (!set.error().empty()) return failed_result(problem, name() + ": " + set.error());
    const std::string unsupported = explain_unsupported(problem);
    if (!unsupported.empty()) return failed_result(problem, name() + ": " + unsupported);

    Evaluator evaluator(problem, set.common(), stop);
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
  } catch (const std::exception& e) {
    return failed_result(problem, name() + ": " + e.what());
  } catch (...) {
    return failed_result(problem, name() + ": an exception that is not a std::exception");
  }
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
