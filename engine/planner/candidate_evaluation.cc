// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/candidate_evaluation.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace prospect {

std::vector<Candidate> evaluate(std::vector<Candidate> candidates, Evaluate what,
                                const CandidateEvaluation& with, const StopCondition& stop) {
  if (candidates.empty()) return candidates;
  const Problem& problem = with.problem;
  Eigen::MatrixXd X(problem.num_variables(), static_cast<Eigen::Index>(candidates.size()));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    X.col(static_cast<Eigen::Index>(i)) = candidates[i].z;
  }
  // Several portions to each thread, as the first ones have rays to cast; of a step with a deadline
  // such that none takes long.
  const bool may_end = stop.left() != StopCondition::kNever;
  const StopCondition asked = one_at_a_time(stop);
  const Eigen::Index portion = may_end ? 2 : with.threads > 1 ? 8 : X.cols();
  const auto portions = static_cast<int>((X.cols() + portion - 1) / portion);
  std::vector<Evaluation> evaluations(static_cast<std::size_t>(portions));
  const auto evaluate_all = [&] {
    std::atomic<bool> all_valid = true;
    with.workers.run(portions, [&](int k) {
      Evaluation& evaluation = evaluations[static_cast<std::size_t>(k)];
      evaluation = {};
      if (may_end && k > 0 && asked() != StopRequest::kNone) return;
      Workspace workspace = problem.make_workspace();
      const Eigen::Index first = k * portion;
      if (!problem.evaluate(X.middleCols(first, std::min(portion, X.cols() - first)), what,
                            workspace, evaluation)) {
        all_valid = false;
      }
    });
    return all_valid.load();
  };
  if (!evaluate_all() && what == Evaluate::kScore) {
    // Single precision may overflow where the exact value does not.
    what = Evaluate::kValue;
    evaluate_all();
  }
  const auto& terms = problem.definition().terms;
  const auto features = std::find_if(terms.begin(), terms.end(), [&](const auto& t) {
    return t.term.get() == with.visible_features;
  });
  std::vector<Candidate> evaluated;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const Evaluation& evaluation = evaluations[static_cast<std::size_t>(at / portion)];
    const Eigen::Index b = at % portion;
    if (evaluation.valid.size() == 0 || !evaluation.valid[b]) continue;  // the first: not begun
    candidates[i].cost = evaluation.cost[b];
    candidates[i].violation = violation(evaluation.constraints.col(b));
    candidates[i].error = evaluation.cost_error[b];
    if (features != terms.end()) {
      candidates[i].features = evaluation.terms(features - terms.begin(), b);
    }
    evaluated.push_back(std::move(candidates[i]));
  }
  std::stable_sort(evaluated.begin(), evaluated.end());
  return evaluated;
}

}  // namespace prospect
