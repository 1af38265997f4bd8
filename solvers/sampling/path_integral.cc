#include "solvers/sampling/path_integral.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/sampling/candidate_rank.h"
#include "solvers/sampling/noise_bank.h"

namespace prospect {

bool path_integral(Evaluator& evaluator, const RateProjection& rate,
                   const PathIntegralSettings& settings, double convergence,
                   Eigen::VectorXd centre) {
  constexpr int kBanks = 8;
  const int n = evaluator.num_variables();
  const int K = settings.samples;
  const bool project = settings.rate_feasible && rate.active();
  // An odd stride per iteration over the bank, so that no iteration repeats another's candidates.
  const int columns = kBanks * K + 1;
  const Eigen::MatrixXd bank = noise_bank(evaluator, columns, settings.correlation);
  const Eigen::VectorXd range = evaluator.upper() - evaluator.lower();
  Eigen::VectorXd sigma = settings.sigma * range;
  Eigen::MatrixXd X(n, K);
  Eigen::ArrayXd cost, violations, weight(K);
  std::vector<double> sorted;
  Eigen::VectorXd mean(n);
  int next = 0;
  while (true) {
    for (int s = 0; s < K; ++s) {
      if (s == 0) {
        X.col(s) = centre;
      } else if (s == 1 && evaluator.has_incumbent()) {
        X.col(s) = evaluator.incumbent();
      } else {
        X.col(s) = centre + sigma.cwiseProduct(bank.col(next));
        next = (next + 1) % columns;
      }
      X.col(s) = X.col(s).cwiseMax(evaluator.lower()).cwiseMin(evaluator.upper());
      if (project) {
        Eigen::VectorXd z = evaluator.expand(X.col(s));
        rate.apply(z);
        X.col(s) = evaluator.reduce(z);
      }
    }
    if (evaluator.evaluate_batch(X, cost, violations) < K) return false;
    evaluator.count_iteration();
    fold_violations(violations, evaluator.options().feasibility_tolerance, cost);
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
    mean.noalias() = X * weight.matrix();
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
