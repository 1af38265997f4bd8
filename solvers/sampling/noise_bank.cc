// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/noise_bank.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace prospect {

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

}  // namespace prospect
