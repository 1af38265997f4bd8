// SPDX-License-Identifier: Apache-2.0
#include "solvers/first_order_residual.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "solvers/descent_direction.h"
#include "solvers/typical_change.h"

namespace prospect {

double first_order_residual(const Problem& problem, const Eigen::VectorXd& x,
                            double feasibility_tolerance) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  constexpr double kAtBound = 1e-6;  // of the width
  if (!problem.has_gradient() || x.size() != problem.num_variables() || !x.allFinite()) {
    return kUnknown;
  }
  Workspace workspace = problem.make_workspace();
  Evaluation e;
  if (!problem.evaluate(x, Evaluate::kGradient, workspace, e)) return kUnknown;
  if (violation(e.constraints.col(0)) > feasibility_tolerance) {
    return std::numeric_limits<double>::infinity();
  }
  std::vector<int> free, active;
  for (int i = 0; i < problem.num_variables(); ++i) {
    if (problem.lower()[i] < problem.upper()[i]) free.push_back(i);
  }
  for (int r = 0; r < problem.num_constraints(); ++r) {
    if (e.constraints(r, 0) <= 10.0 * feasibility_tolerance) active.push_back(r);
  }
  if (free.empty()) return 0.0;
  const Eigen::VectorXd lower = problem.lower()(free);
  const Eigen::VectorXd width = problem.upper()(free) - lower;
  Eigen::VectorXd shares = (x(free) - lower).cwiseQuotient(width);
  for (double& share : shares) {
    share = share <= kAtBound ? 0.0 : share >= 1.0 - kAtBound ? 1.0 : share;
  }
  const Eigen::VectorXd change = typical_change(x(free), lower, lower + width);
  const Eigen::VectorXd g = e.gradient(free).cwiseProduct(change);
  const Eigen::MatrixXd A = e.jacobian(active, free) * change.asDiagonal();
  const Eigen::VectorXd d = descent_direction(g, A, shares);
  return d.lpNorm<Eigen::Infinity>() / std::max(1.0, std::abs(e.cost[0]));
}

}  // namespace prospect
