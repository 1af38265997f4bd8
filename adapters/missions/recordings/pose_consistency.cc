// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/pose_consistency.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "engine/support/cholesky.h"
#include "engine/support/quantile.h"

namespace prospect {
namespace {

// Quantiles of chi-squared, 1 to 6 degrees of freedom.
constexpr std::array<double, 6> kMedian = {0.454936, 1.386294, 2.365974,
                                           3.356694, 4.351460, 5.348121};
constexpr std::array<double, 6> k95 = {3.841459, 5.991465,  7.814728,
                                       9.487729, 11.070498, 12.591587};

}  // namespace

double normalised_error_squared(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (!error.allFinite() || !covariance.allFinite()) return nan;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(covariance);
  if (cholesky.info() != Eigen::Success) return nan;
  return error.dot(cholesky.solve(error));
}

PoseConsistency pose_consistency(const std::vector<double>& normalised, int degrees) {
  if (degrees < 1 || degrees > 6) {
    throw std::invalid_argument("pose consistency: " + std::to_string(degrees) +
                                " degrees of freedom; expected 1 to 6");
  }
  PoseConsistency c;
  c.degrees = degrees;
  std::vector<double> finite;
  for (const double x : normalised) {
    if (std::isnan(x)) continue;
    finite.push_back(x);
    c.mean += x / degrees;
    c.within_95 += x <= k95[degrees - 1];
  }
  c.count = static_cast<int>(finite.size());
  if (c.count == 0) return c;
  c.mean /= c.count;
  c.within_95 /= c.count;
  c.median = quantile(finite, 0.5) / kMedian[degrees - 1];
  return c;
}

}  // namespace prospect
