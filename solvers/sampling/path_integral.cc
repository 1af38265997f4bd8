// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/path_integral.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/sampling/candidate_rounds.h"

namespace prospect {

bool path_integral(Evaluator& evaluator, const RateProjection& rate,
                   const PathIntegralSettings& settings, double convergence,
                   Eigen::VectorXd centre) {
  const int n = evaluator.num_variables();
  const int K = settings.samples;
  CandidateRounds rounds(evaluator, rate, settings.rate_feasible, K, settings.correlation);
  const Eigen::MatrixXd& X = rounds.candidates();
  const Eigen::ArrayXd& cost = rounds.cost();
  const Eigen::VectorXd range = evaluator.upper() - evaluator.lower();
  Eigen::VectorXd sigma = settings.sigma * range;
  Eigen::ArrayXd weight(K);
  std::vector<double> sorted;
  while (true) {
    if (!rounds.next(centre, sigma)) return false;
    sorted.clear();
    for (int s = 0; s < K; ++s) {
      if (std::isfinite(cost[s])) sorted.push_back(cost[s]);
    }
    if (sorted.empty()) {
      if (!evaluator.has_incumbent()) return false;
      centre = evaluator.incumbent();
      continue;
    }
    const auto fifth = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) / 5);
    std::nth_element(sorted.begin(), fifth, sorted.end());
    const double quantile = *fifth;
    const double least = *std::min_element(sorted.begin(), sorted.end());
    const double lambda = settings.temperature * (quantile - least);
    for (int s = 0; s < K; ++s) {
      if (!std::isfinite(cost[s])) {
        weight[s] = 0.0;
      } else if (lambda > 0.0) {
        weight[s] = std::exp(-(cost[s] - least) / lambda);
      } else {
        weight[s] = cost[s] <= least ? 1.0 : 0.0;
      }
    }
    weight /= weight.sum();  // >= 1 before: the best candidate has weight 1
    const Eigen::VectorXd mean = X * weight.matrix();
    for (int i = 0; i < n; ++i) {
      const double scatter = (weight * (X.row(i).array().transpose() - centre[i]).square()).sum();
      const double variance =
          (1.0 - settings.adaptation) * sigma[i] * sigma[i] + settings.adaptation * scatter;
      sigma[i] = std::sqrt(std::max(0.0, variance));
    }
    centre = mean.cwiseMax(evaluator.lower()).cwiseMin(evaluator.upper());
    if ((sigma.array() <= convergence * range.array()).all()) return true;
  }
}

}  // namespace prospect
