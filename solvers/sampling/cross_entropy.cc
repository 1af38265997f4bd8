// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/cross_entropy.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/sampling/candidate_rounds.h"

namespace prospect {

bool cross_entropy(Evaluator& evaluator, const RateProjection& rate,
                   const CrossEntropySettings& settings, double convergence, Eigen::VectorXd mean) {
  const int n = evaluator.num_variables();
  const int K = settings.samples;
  CandidateRounds rounds(evaluator, rate, settings.rate_feasible, K, settings.correlation);
  const Eigen::MatrixXd& X = rounds.candidates();
  const Eigen::ArrayXd& cost = rounds.cost();
  const Eigen::VectorXd range = evaluator.upper() - evaluator.lower();
  Eigen::VectorXd sigma = settings.sigma * range;
  std::vector<int> order;
  Eigen::VectorXd elite_mean(n), elite_sigma(n);
  const int most = std::clamp(static_cast<int>(std::lround(settings.elite * K)), 2, K);
  while (true) {
    if (!rounds.next(mean, sigma)) return false;
    order.clear();
    for (int s = 0; s < K; ++s) {
      if (std::isfinite(cost[s])) order.push_back(s);
    }
    if (order.empty()) {
      if (!evaluator.has_incumbent()) return false;
      mean = evaluator.incumbent();
      continue;
    }
    // By number where costs are equal: the same bits on every run.
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return cost[a] != cost[b] ? cost[a] < cost[b] : a < b; });
    const int elite = std::min(most, static_cast<int>(order.size()));
    elite_mean.setZero();
    elite_sigma.setZero();
    for (int e = 0; e < elite; ++e) {
      elite_mean += X.col(order[static_cast<std::size_t>(e)]) / elite;
    }
    for (int e = 0; e < elite; ++e) {
      elite_sigma += (X.col(order[static_cast<std::size_t>(e)]) - mean).cwiseAbs2() / elite;
    }
    const double a = settings.smoothing;
    mean =
        ((1.0 - a) * mean + a * elite_mean).cwiseMax(evaluator.lower()).cwiseMin(evaluator.upper());
    sigma = (1.0 - a) * sigma + a * elite_sigma.cwiseSqrt();
    if ((sigma.array() <= convergence * range.array()).all()) return true;
  }
}

}  // namespace prospect
