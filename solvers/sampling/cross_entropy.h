// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solvers/evaluator.h"
#include "solvers/sampling/rate_projection.h"

namespace prospect {

/// The cross-entropy method on the knot inputs, with a diagonal covariance.
///
/// One iteration draws K candidates x_s = mu + sigma .* eps_s, truncated to the bounds and
/// projected into the rate limits, and fits the distribution to its elite E, the best `elite` K of
/// them:
///   mu    <- (1 - a) mu + a mean_E x,          a = smoothing,
///   sigma <- (1 - a) sigma + a sqrt(mean_E (x - mu)^2),   mu of before the step.
/// The spread is taken about the old mean, as covariance matrix adaptation does: about that of the
/// elite, sigma collapses on a slope and the method stops far from any minimum.
/// Candidates are ranked as in candidate_rank.h: feasible before infeasible; rejected ones are
/// never elite. The mean itself and the incumbent are among the candidates.
///
/// Drawn and evaluated by candidate_rounds.h.
///
/// Source: Rubinstein (1999); smoothing as in de Boer, Kroese, Mannor and Rubinstein, "A tutorial
/// on the cross-entropy method" (2005), section 3.
struct CrossEntropySettings {
  int samples = 128;         ///< K >= 4
  double sigma = 0.3;        ///< at the start [fraction of the range of each variable] (0, 1]
  double elite = 0.05;       ///< share of the candidates, (0, 1]; at least two are elite
  double smoothing = 0.5;    ///< a, (0, 1]; 1: only the elite counts
  double correlation = 0.8;  ///< of the noise over the knots, 0..1 [-]
  bool rate_feasible = true;
};

/// Iterates from `mean` (free variables) until all of sigma is below `convergence` (fraction of the
/// ranges) or the evaluator stops. Returns whether it converged.
bool cross_entropy(Evaluator& evaluator, const RateProjection& rate,
                   const CrossEntropySettings& settings, double convergence, Eigen::VectorXd mean);

}  // namespace prospect
