// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/candidate_rounds.h"

#include "solvers/sampling/candidate_rank.h"
#include "solvers/sampling/noise_bank.h"

namespace prospect {
namespace {

constexpr int kBanks = 8;

}  // namespace

// One column more than whole rounds take, so that no round repeats another's candidates.
CandidateRounds::CandidateRounds(Evaluator& evaluator, const RateProjection& rate,
                                 bool rate_feasible, int samples, double correlation)
    : evaluator_(evaluator),
      rate_(rate),
      project_(rate_feasible && rate.active()),
      bank_(noise_bank(evaluator, kBanks * samples + 1, correlation)),
      X_(evaluator.num_variables(), samples) {}

bool CandidateRounds::next(const Eigen::VectorXd& centre, const Eigen::VectorXd& sigma) {
  for (Eigen::Index s = 0; s < X_.cols(); ++s) {
    if (s == 0) {
      X_.col(s) = centre;
    } else if (s == 1 && evaluator_.has_incumbent()) {
      X_.col(s) = evaluator_.incumbent();
    } else {
      X_.col(s) = centre + sigma.cwiseProduct(bank_.col(next_));
      next_ = (next_ + 1) % bank_.cols();
    }
    X_.col(s) = X_.col(s).cwiseMax(evaluator_.lower()).cwiseMin(evaluator_.upper());
    if (project_) {
      Eigen::VectorXd z = evaluator_.expand(X_.col(s));
      rate_.apply(z);
      X_.col(s) = evaluator_.reduce(z);
    }
  }
  if (evaluator_.evaluate_batch(X_, cost_, violation_, Evaluate::kScore) < X_.cols()) return false;
  evaluator_.count_iteration();
  fold_violations(violation_, evaluator_.options().feasibility_tolerance, cost_);
  return true;
}

}  // namespace prospect
