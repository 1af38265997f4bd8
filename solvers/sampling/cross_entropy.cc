#include "solvers/sampling/cross_entropy.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/sampling/candidate_rank.h"
#include "solvers/sampling/noise_bank.h"

namespace prospect {

bool cross_entropy(Evaluator& evaluator, const RateProjection& rate,
                   const CrossEntropySettings& settings, double convergence, Eigen::VectorXd mean) {
  constexpr int kBanks = 8;
  const int n = evaluator.num_variables();
  const int K = settings.samples;
  const bool project = settings.rate_feasible && rate.active();
  // One column more than whole iterations take, so that no iteration repeats another's candidates.
  const int columns = kBanks * K + 1;
  const Eigen::MatrixXd bank = noise_bank(evaluator, columns, settings.correlation);
  const Eigen::VectorXd range = evaluator.upper() - evaluator.lower();
  Eigen::VectorXd sigma = settings.sigma * range;
  Eigen::MatrixXd X(n, K);
  Eigen::ArrayXd cost, violations;
  std::vector<int> order;
  Eigen::VectorXd elite_mean(n), elite_sigma(n);
  const int most = std::clamp(static_cast<int>(std::lround(settings.elite * K)), 2, K);
  int next = 0;
  while (true) {
    for (int s = 0; s < K; ++s) {
      if (s == 0) {
        X.col(s) = mean;
      } else if (s == 1 && evaluator.has_incumbent()) {
        X.col(s) = evaluator.incumbent();
      } else {
        X.col(s) = mean + sigma.cwiseProduct(bank.col(next));
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
