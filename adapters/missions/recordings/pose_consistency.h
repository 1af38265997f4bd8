// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace prospect {

/// Normalised estimation error squared (Bar-Shalom, Li, Kirubarajan 2001, 5.4): errors e against
/// the covariances C that were claimed for them, e^T C^-1 e. Where the claims are true and the
/// errors Gaussian it is chi-squared distributed with as many degrees of freedom as e has entries.
struct PoseConsistency {
  int count = 0;           ///< errors
  int degrees = 0;         ///< of freedom, of each
  double mean = 0.0;       ///< of e^T C^-1 e / degrees: 1 if true, above: too sure, below: too shy
  double median = 0.0;     ///< of the same, over the median of chi-squared: outliers do not count
  double within_95 = 0.0;  ///< share within the 95 % bound of chi-squared: 0.95 if true
};

/// e^T C^-1 e; NaN if C is not positive definite or anything is not finite.
double normalised_error_squared(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// Of normalised errors of 1 to 6 degrees of freedom each; NaN ones are left out. All zero without
/// any. Throws std::invalid_argument for other degrees of freedom.
PoseConsistency pose_consistency(const std::vector<double>& normalised, int degrees);

}  // namespace prospect
