#include "solvers/hybrid/neighbours.h"

#include <algorithm>
#include <cmath>

#include "solvers/sampling/additive_recurrence.h"

namespace prospect {

Eigen::MatrixXd neighbours(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& z,
                           int first, int count) {
  const int nu = problem.horizon().nu();
  const int M = problem.definition().M;
  const Eigen::VectorXd step = additive_recurrence_steps(2 + nu);
  Eigen::MatrixXd Z = z.replicate(1, std::max(count, 0));
  Eigen::VectorXd t(step.size());
  for (Eigen::Index c = 0; c < Z.cols(); ++c) {
    t = (0.5 + static_cast<double>(first + c) * step.array());
    t.array() -= t.array().floor();
    const int length = 1 + std::min(M - 1, static_cast<int>(t[0] * M));
    const int start = std::min(M - length, static_cast<int>(t[1] * (M - length + 1)));
    for (int m = start; m < start + length; ++m) {
      for (int j = 0; j < nu; ++j) {
        const int i = m * nu + j;
        const double lower = problem.lower()[i], upper = problem.upper()[i];
        const double share = std::clamp(1.5 * t[2 + j] - 0.25, 0.0, 1.0);
        Z(i, c) = std::min(upper, lower + (upper - lower) * share);
      }
    }
  }
  return Z;
}

}  // namespace prospect
