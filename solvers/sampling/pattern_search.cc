// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/pattern_search.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace prospect {

bool pattern_search(Evaluator& evaluator, const RateProjection& rate, bool rate_feasible,
                    double step, double convergence) {
  const int n = evaluator.num_variables();
  const int nu = evaluator.problem().horizon().nu();
  const bool project = rate_feasible && rate.active();
  const bool several_knots = evaluator.problem().definition().M > 1;
  const int fixed_directions = several_knots ? 2 * n : n;
  const int directions = fixed_directions + n;
  std::mt19937_64 generator(evaluator.options().seed);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd range = evaluator.upper() - evaluator.lower();
  const double tolerance = evaluator.options().feasibility_tolerance;
  const std::vector<int>& free = evaluator.free_variables();

  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(n, directions);
  for (int i = 0; i < n; ++i) {
    D(i, i) = range[i];
    for (int j = i; several_knots && j < n; ++j) {
      const bool same_input =
          (free[static_cast<std::size_t>(j)] - free[static_cast<std::size_t>(i)]) % nu == 0;
      if (same_input) D(j, n + i) = range[j];
    }
  }

  const auto make_admissible = [&](Eigen::Ref<Eigen::VectorXd> x) {
    x = x.cwiseMax(evaluator.lower()).cwiseMin(evaluator.upper());
    if (project) {
      Eigen::VectorXd z = evaluator.expand(x);
      rate.apply(z);
      x = evaluator.reduce(z);
    }
  };

  Eigen::MatrixXd X(n, 2 * directions), extra(n, 2);
  Eigen::ArrayXd cost, violations, extra_cost, extra_violations;
  Eigen::VectorXd success = Eigen::VectorXd::Zero(n);
  while (step > convergence) {
    const Eigen::VectorXd x = evaluator.incumbent();
    const double value = evaluator.incumbent_cost();
    const double violation = evaluator.incumbent_violation();
    for (int d = fixed_directions; d < directions; ++d) {
      for (int i = 0; i < n; ++i) D(i, d) = normal(generator);
      D.col(d) = D.col(d).normalized().cwiseProduct(range);
    }
    for (int d = 0; d < directions; ++d) {
      X.col(2 * d) = x + step * D.col(d);
      X.col(2 * d + 1) = x - step * D.col(d);
    }
    for (Eigen::Index c = 0; c < X.cols(); ++c) make_admissible(X.col(c));
    if (evaluator.evaluate_batch(X, cost, violations) < X.cols()) return false;
    evaluator.count_iteration();

    // Each variable on its own: the minimum of the parabola through (-s, 0, +s), within the poll.
    extra.col(0) = x;
    for (int i = 0; i < n; ++i) {
      const bool usable = violations[2 * i] <= std::max(tolerance, violation) &&
                          violations[2 * i + 1] <= std::max(tolerance, violation);
      if (!usable) continue;
      const double a = X(i, 2 * i) - x[i];
      const double b = X(i, 2 * i + 1) - x[i];
      const double fa = cost[2 * i] - value;
      const double fb = cost[2 * i + 1] - value;
      if (a == 0.0 || b == 0.0 || a == b) {
        if (a != 0.0 && fa < 0.0) extra(i, 0) += a;
        if (b != 0.0 && fb < 0.0) extra(i, 0) += b;
        continue;
      }
      const double curvature = (fa / a - fb / b) / (a - b);
      const double slope = fa / a - curvature * a;
      const double move = curvature > 0.0 ? -0.5 * slope / curvature : (fa < fb ? a : b);
      extra(i, 0) += std::clamp(move, std::min(a, b), std::max(a, b));
    }
    extra.col(1) = evaluator.incumbent() + success;
    make_admissible(extra.col(0));
    make_admissible(extra.col(1));
    if (evaluator.evaluate_batch(extra, extra_cost, extra_violations) < 2) return false;

    const bool better = evaluator.incumbent() != x;
    if (better) {
      success = evaluator.incumbent() - x;
      const double gain = value - evaluator.incumbent_cost();
      const bool small = evaluator.incumbent_violation() >= violation &&
                         gain <= evaluator.options().tolerance * std::max(1.0, std::abs(value));
      step = small ? 0.5 * step : std::min(2.0 * step, 0.5);
    } else {
      success.setZero();
      step *= 0.5;
    }
  }
  return true;
}

}  // namespace prospect
