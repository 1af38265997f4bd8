// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace prospect {

/// Variance of the noise of tracked points over the one that is assumed, estimated from residuals:
/// chi-squared of the newest poses over their degrees of freedom, where older ones count less and
/// less. What is assumed counts as `prior_degrees` degrees of freedom of ratio 1.
class ResidualNoise {
 public:
  explicit ResidualNoise(double prior_degrees = 100.0, double memory_frames = 20.0)
      : prior_(prior_degrees), keep_(1.0 - 1.0 / memory_frames) {}

  /// Of a new pose.
  void add(double chi2_per_degree, int degrees) {
    newest_ = chi2_per_degree;
    chi2_ = keep_ * chi2_ + chi2_per_degree * degrees;
    degrees_ = keep_ * degrees_ + degrees;
  }
  /// For the newest pose, whose own residuals count where they are more than those before.
  double variance() const { return std::max(newest_, (chi2_ + prior_) / (degrees_ + prior_)); }

 private:
  double prior_, keep_;
  double newest_ = 0.0, chi2_ = 0.0, degrees_ = 0.0;
};

}  // namespace prospect
