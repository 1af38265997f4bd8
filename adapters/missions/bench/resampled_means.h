// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace prospect {

/// A mean, or a ratio of two, and where it lies with 95 % of the resamples.
struct MeanInterval {
  double mean = 0.0, low = 0.0, high = 0.0;
};

/// Percentile intervals (B. Efron, 1979) of means over `samples` problems or pairs of missions: of
/// resamples of as many, drawn with replacement. All means that one object gives are of the same
/// resamples, so that curves and pairs stay whole. Deterministic by `seed`. Thread-safe.
class ResampledMeans {
 public:
  explicit ResampledMeans(int samples, int resamples = 1000, std::uint64_t seed = 1);

  /// One mean for each column of finite values, samples x columns. NaN without samples.
  std::vector<MeanInterval> intervals(const Eigen::MatrixXd& values) const;
  MeanInterval interval(const Eigen::VectorXd& values) const;
  /// Mean of second over mean of first: defined with zeros among them, as ratios of samples are
  /// not. Resamples whose ratio is not finite are left out; NaN if none is left.
  MeanInterval ratio(const Eigen::VectorXd& first, const Eigen::VectorXd& second) const;

 private:
  Eigen::MatrixXd weights_;  // resamples x samples; how often each was drawn, over their number
};

/// Two-sided p value of the paired test by randomisation: the share of random changes of signs of
/// the differences, one a problem, whose mean is as far from 0 as the one observed, that one
/// counted. Assumes only that, without an effect, a difference is as likely to have either sign. 1
/// without a difference. Finite values. Deterministic by `seed`.
double sign_flip_p(const Eigen::VectorXd& differences, int flips = 9999, std::uint64_t seed = 1);

}  // namespace prospect
