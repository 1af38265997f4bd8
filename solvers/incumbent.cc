// SPDX-License-Identifier: Apache-2.0
#include "solvers/incumbent.h"

#include <algorithm>
#include <cmath>

namespace prospect {

void approach_from_incumbent(Evaluator& evaluator, const Eigen::VectorXd& x) {
  if (!evaluator.incumbent_feasible()) return;
  if (evaluator.evaluate(x, Evaluate::kValue) != EvaluationOutcome::kEvaluated) return;
  const double tolerance = evaluator.options().feasibility_tolerance;
  if (violation(evaluator.constraints()) <= tolerance) return;
  const Eigen::VectorXd feasible = evaluator.incumbent();
  double from = 0.0, to = 1.0;
  for (int i = 0; i < 12; ++i) {
    const double t = 0.5 * (from + to);
    const Eigen::VectorXd between = feasible + t * (x - feasible);
    const EvaluationOutcome outcome = evaluator.evaluate(between, Evaluate::kValue);
    if (outcome == EvaluationOutcome::kStopped) return;
    const bool good =
        outcome == EvaluationOutcome::kEvaluated && violation(evaluator.constraints()) <= tolerance;
    (good ? from : to) = t;
  }
}

bool incumbent_is_as_good(Evaluator& evaluator, const Eigen::VectorXd& x) {
  if (evaluator.stopped() || !evaluator.incumbent_feasible()) return false;
  if (evaluator.evaluate(x, Evaluate::kValue) != EvaluationOutcome::kEvaluated) return false;
  const double slack = std::max(evaluator.options().tolerance, 1e-9);
  return evaluator.incumbent_cost() <=
         evaluator.cost() + 10.0 * slack * std::max(1.0, std::abs(evaluator.cost()));
}

}  // namespace prospect
