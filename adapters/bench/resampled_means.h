#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace prospect {

/// A mean, and where it lies with 95 % of the resamples.
struct MeanInterval {
  double mean = 0.0, low = 0.0, high = 0.0;
};

/// Percentile intervals (B. Efron, 1979) of means over `problems` problems: of resamples of as many
/// problems, drawn with replacement. All means that one object gives are of the same resamples, so
/// that curves stay whole. Deterministic by `seed`. Thread-safe.
class ResampledMeans {
 public:
  explicit ResampledMeans(int problems, int resamples = 1000, std::uint64_t seed = 1);

  /// One mean for each column of finite values, problems x columns. NaN without problems.
  std::vector<MeanInterval> intervals(const Eigen::MatrixXd& values) const;
  MeanInterval interval(const Eigen::VectorXd& values) const;

 private:
  Eigen::MatrixXd weights_;  // resamples x problems; how often each was drawn, over their number
};

/// Two-sided p value of the paired test by randomisation: the share of random changes of signs of
/// the differences, one a problem, whose mean is as far from 0 as the one observed, that one
/// counted. Assumes only that, without an effect, a difference is as likely to have either sign. 1
/// without a difference. Finite values. Deterministic by `seed`.
double sign_flip_p(const Eigen::VectorXd& differences, int flips = 9999, std::uint64_t seed = 1);

}  // namespace prospect
