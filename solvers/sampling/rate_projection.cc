// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/rate_projection.h"

#include <algorithm>
#include <cmath>

namespace prospect {

RateProjection::RateProjection(const Problem& problem)
    : problem_(problem),
      step_(problem.definition().model->limits().rate * problem.definition().dt),
      active_(step_.array().isFinite().any()) {}

void RateProjection::apply(Eigen::Ref<Eigen::VectorXd> z) const {
  if (!active_) return;
  const ProblemDefinition& d = problem_.definition();
  const Eigen::Index nu = step_.size();
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    const Eigen::Index j = i % nu;
    if (std::isfinite(step_[j])) {
      const double before = i < nu ? d.u_previous[j] : z[i - nu];
      z[i] = std::clamp(z[i], before - step_[j], before + step_[j]);
    }
    z[i] = std::clamp(z[i], problem_.lower()[i], problem_.upper()[i]);
  }
}

}  // namespace prospect
