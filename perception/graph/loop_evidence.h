// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace prospect {

/// What speaks for a loop, in nats.
struct LoopEvidence {
  /// log p(r | right) / p(r | wrong).
  double score = 0.0;
  /// log of the share of wrong loops that would fit as well.
  double chance = 0.0;
  /// q, the squared innovation over its covariance, in as many dimensions as the loop tells
  /// something in.
  double chi2 = 0.0;
};

/// A loop's innovation r = log(T^-1 T_a^-1 T_b) against what the rest of the graph predicts.
///
/// If the loop is right, r has the covariance s^2 P, P that of the prediction and of the
/// measurement together, s what the information of this graph is off by. If it is wrong, it says
/// nothing: its ends are any two poses, r has s^2 P + W. With the eigenvalues lambda_k of W against
/// s^2 P, and r = y in the basis where s^2 P is the identity and W diagonal,
///   q = sum y_k^2 lambda_k / (1 + lambda_k),       d = sum lambda_k / (1 + lambda_k),
///   score  =  1/2 sum log(1 + lambda_k) - (nu + d) / 2 log(1 + q / nu),
///   chance = -1/2 sum log(1 + lambda_k) + d/2 log(max(q, d) / 2) - log Gamma(d/2 + 1).
/// A loop between poses that are known well is told right from wrong surely; one that closes a long
/// way could by chance be wrong and fit. Directions in which poses do not differ (lambda_k = 0: up
/// and down in the plane) count for nothing. Student's t with nu degrees stands for Gauss, as
/// covariances are never known well. `chance` is the volume of the ellipsoid q under N(0, W).
class LoopTest {
 public:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  /// P positive definite, W positive semidefinite.
  LoopTest(const Vector6d& r, const Matrix6d& P, const Matrix6d& W);
  LoopEvidence evidence(double s, double nu) const;

 private:
  Vector6d squares_, lambda_;  // y_k^2 and lambda_k for s = 1
};

/// W: the mean of x x^T over the pairs of 64 poses, evenly spaced, x = log(T_a^-1 T_b).
Eigen::Matrix<double, 6, 6> pose_spread(const std::vector<Eigen::Isometry3d>& poses);

/// The share of right loops among those with these scores and `known` more that are right, by
/// maximum likelihood (expectation maximisation) with one right and one wrong one added.
double share_of_right(const std::vector<double>& scores, int known);

}  // namespace prospect
