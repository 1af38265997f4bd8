// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/systematic_search.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/sampling/additive_recurrence.h"

namespace prospect {
namespace {

constexpr int kMostLevels = 33;

/// levels^nu, or a number above `most`.
double power(int levels, int nu) { return std::pow(static_cast<double>(levels), nu); }

int finest(int nu, double most, double (*count)(double)) {
  int levels = 0;
  while (levels < kMostLevels && count(power(levels + 1, nu)) <= most) ++levels;
  return levels;
}

/// nu x levels^nu: every point of the grid.
Eigen::MatrixXd grid(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, int levels) {
  const auto nu = static_cast<int>(lower.size());
  Eigen::MatrixXd axis(nu, levels);
  for (int j = 0; j < nu; ++j) {
    for (int i = 0; i < levels; ++i) {
      axis(j, i) = levels == 1 ? 0.5 * (lower[j] + upper[j])
                               : lower[j] + (upper[j] - lower[j]) * i / (levels - 1);
    }
    if (lower[j] <= 0.0 && upper[j] >= 0.0) {
      Eigen::Index nearest = 0;
      axis.row(j).cwiseAbs().minCoeff(&nearest);
      axis(j, nearest) = 0.0;
    }
  }
  const auto count = static_cast<int>(std::lround(power(levels, nu)));
  Eigen::MatrixXd points(nu, count);
  for (int c = 0; c < count; ++c) {
    int rest = c;
    for (int j = 0; j < nu; ++j, rest /= levels) points(j, c) = axis(j, rest % levels);
  }
  return points;
}

/// nu x count points that fill the box evenly.
Eigen::MatrixXd additive_recurrence(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                    int count) {
  const auto nu = static_cast<int>(lower.size());
  const Eigen::VectorXd step = additive_recurrence_steps(nu);
  Eigen::MatrixXd points(nu, count);
  for (int j = 0; j < nu; ++j) {
    for (int c = 0; c < count; ++c) {
      const double t = 0.5 + (c + 1) * step[j];
      points(j, c) = lower[j] + (upper[j] - lower[j]) * (t - std::floor(t));
    }
  }
  return points;
}

}  // namespace

Eigen::MatrixXd systematic_candidates(const Problem& problem, int most) {
  const ProblemDefinition& d = problem.definition();
  const int nu = problem.horizon().nu();
  const Eigen::VectorXd lower = problem.lower().head(nu);
  const Eigen::VectorXd upper = problem.upper().head(nu);
  if (most < 1) return Eigen::MatrixXd(problem.num_variables(), 0);

  const int constant_share = d.M == 1 ? most : std::max(1, most / 4);
  const int levels = finest(nu, constant_share, [](double points) { return points; });
  if (levels < 2) return additive_recurrence(lower, upper, most).replicate(d.M, 1);
  const Eigen::MatrixXd constants = grid(lower, upper, levels);

  std::vector<int> switches;
  for (const int s : {d.M / 2, d.M / 4, d.M - d.M / 4}) {
    if (s > 0 && s < d.M && std::find(switches.begin(), switches.end(), s) == switches.end()) {
      switches.push_back(s);
    }
  }
  const auto left = most - static_cast<int>(constants.cols());
  int pair_levels = 0;
  if (!switches.empty()) {
    pair_levels = finest(nu, static_cast<double>(left) / static_cast<double>(switches.size()),
                         [](double points) { return points * (points - 1.0); });
  }
  Eigen::MatrixXd ends(nu, 0);
  if (pair_levels >= 2) ends = grid(lower, upper, pair_levels);
  const Eigen::Index pairs = ends.cols() * std::max<Eigen::Index>(ends.cols() - 1, 0);

  Eigen::MatrixXd candidates(problem.num_variables(),
                             constants.cols() + pairs * static_cast<Eigen::Index>(switches.size()));
  candidates.leftCols(constants.cols()) = constants.replicate(d.M, 1);
  Eigen::Index column = constants.cols();
  for (const int s : switches) {
    for (Eigen::Index a = 0; a < ends.cols(); ++a) {
      for (Eigen::Index b = 0; b < ends.cols(); ++b) {
        if (a == b) continue;
        candidates.col(column).head(s * nu) = ends.col(a).replicate(s, 1);
        candidates.col(column).tail((d.M - s) * nu) = ends.col(b).replicate(d.M - s, 1);
        ++column;
      }
    }
  }
  return candidates;
}

}  // namespace prospect
