// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solvers/evaluator.h"
#include "solvers/sampling/rate_projection.h"

namespace prospect {

/// Rounds of random candidates about a moving centre: what the path integral and the cross-entropy
/// method share.
///
/// A round of K candidates is the centre, the incumbent (if there is one) and
/// x_s = centre + sigma .* eps_s, truncated to the bounds and, if asked for, projected into the
/// rate limits; eps comes from the bank of noise_bank.h. Costs are those of candidate_rank.h:
/// violations folded in, infinite for rejected candidates.
///
/// The evaluator and the projection must outlive it. Thread-safety: none. Deterministic.
class CandidateRounds {
 public:
  CandidateRounds(Evaluator& evaluator, const RateProjection& rate, bool rate_feasible, int samples,
                  double correlation);

  /// Draws and evaluates the next round. False if the evaluator stopped before all were evaluated.
  bool next(const Eigen::VectorXd& centre, const Eigen::VectorXd& sigma);

  const Eigen::MatrixXd& candidates() const { return X_; }  ///< n x K, free variables
  const Eigen::ArrayXd& cost() const { return cost_; }      ///< K

 private:
  Evaluator& evaluator_;
  const RateProjection& rate_;
  bool project_;
  Eigen::MatrixXd bank_, X_;
  Eigen::ArrayXd cost_, violation_;
  Eigen::Index next_ = 0;  // column of the bank
};

}  // namespace prospect
