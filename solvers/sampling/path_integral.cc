#include "solvers/sampling/path_integral.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace prospect {
namespace {

/// Standard normal numbers, free variables x columns, drawn once; candidates take its columns in
/// turn.
Eigen::MatrixXd noise_bank(const Evaluator& evaluator, int columns, double correlation) {
  std::mt19937_64 generator(evaluator.options().seed);
  std::normal_distribution<double> normal;
  const int nu = evaluator.problem().horizon().nu();
  const double fresh = std::sqrt(std::max(0.0, 1.0 - correlation * correlation));
  Eigen::VectorXd z(evaluator.problem().num_variables());
  Eigen::MatrixXd bank(evaluator.num_variables(), columns);
  for (int c = 0; c < columns; ++c) {
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      const double eta = normal(generator);
      z[i] = (c % 2 == 1 && i >= nu) ? correlation * z[i - nu] + fresh * eta : eta;
    }
    bank.col(c) = evaluator.reduce(z);
  }
  return bank;
}

/// Costs with the violations folded in, see the header; infinite for rejected candidates.
void rank(const Eigen::ArrayXd& violation, double tolerance, Eigen::ArrayXd& cost) {
  double least = 0.0, most = 0.0;
  bool any = false;
  for (Eigen::Index s = 0; s < cost.size(); ++s) {
    if (violation[s] > tolerance) continue;
    least = any ? std::min(least, cost[s]) : cost[s];
    most = any ? std::max(most, cost[s]) : cost[s];
    any = true;
  }
  const double spread = std::max(most - least, 1e-9 * std::max(1.0, std::abs(most)));
  double largest = 0.0;
  for (Eigen::Index s = 0; s < cost.size(); ++s) {
    if (std::isfinite(violation[s])) largest = std::max(largest, violation[s]);
  }
  for (Eigen::Index s = 0; s < cost.size(); ++s) {
    if (violation[s] <= tolerance) continue;
    cost[s] = !std::isfinite(violation[s]) ? violation[s]
              : any                        ? most + spread * (0.1 + violation[s] / largest)
                                           : violation[s];
  }
}

}  // namespace

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
    rank(violations, evaluator.options().feasibility_tolerance, cost);
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
