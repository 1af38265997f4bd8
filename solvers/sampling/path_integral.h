// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solvers/evaluator.h"
#include "solvers/sampling/rate_projection.h"

namespace prospect {

/// Model predictive path integral control on the knot inputs.
///
/// One iteration draws K candidates x_s = centre + sigma .* eps_s, clamps them into bounds and rate
/// limits, and moves the centre to their weighted mean
///   w_s ∝ exp(-(J_s - min J) / lambda),   lambda = temperature (J_q - min J),
/// J_q being the cost at the best fifth of the candidates: a temperature relative to the spread of
/// the costs needs no tuning to their unit. The spread follows the weighted candidates,
///   sigma_i^2 <- (1 - a) sigma_i^2 + a sum_s w_s (x_si - centre_i)^2,   a = adaptation.
/// The centre itself and the incumbent are among the candidates.
///
/// J of a candidate with violated constraints lies above that of all feasible ones and grows with
/// the violation (candidate_rank.h); rejected candidates have no weight. No weight is ever NaN: if
/// all costs are equal, so are the weights.
///
/// Drawn and evaluated by candidate_rounds.h.
///
/// Source: Williams et al. (2017), information-theoretic MPPI; adaptation as in Stulp and Sigaud
/// (2012), PI2-CMA, here a diagonal. Knots instead of stages, the relative temperature and the
/// ranking of infeasible candidates are our choice.
struct PathIntegralSettings {
  int samples = 64;          ///< K >= 4
  double sigma = 0.2;        ///< [fraction of the range of each variable] (0, 1]
  double temperature = 0.1;  ///< > 0 [-]
  double adaptation = 0.4;   ///< 0..1, 0: sigma stays
  double correlation = 0.8;  ///< c, 0..1 [-]
  bool rate_feasible = true;
};

/// Iterates from `centre` (free variables) until all of sigma is below `convergence` (fraction of
/// the ranges) or the evaluator stops. Returns whether it converged.
bool path_integral(Evaluator& evaluator, const RateProjection& rate,
                   const PathIntegralSettings& settings, double convergence,
                   Eigen::VectorXd centre);

}  // namespace prospect
