// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/resampled_means.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>

#include "engine/support/quantile.h"

namespace prospect {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The percentiles of those that are finite.
MeanInterval within(double value, const Eigen::VectorXd& resampled) {
  std::vector<double> all;
  std::copy_if(resampled.begin(), resampled.end(), std::back_inserter(all),
               [](double v) { return std::isfinite(v); });
  if (all.empty()) return {value, kNone, kNone};
  return {value, quantile(all, 0.025), quantile(all, 0.975)};
}

}  // namespace

ResampledMeans::ResampledMeans(int samples, int resamples, std::uint64_t seed)
    : weights_(Eigen::MatrixXd::Zero(resamples, samples)) {
  if (samples < 1) return;
  // The remainder favours no sample by more than samples / 2^64.
  std::mt19937_64 draw(seed);
  for (int r = 0; r < resamples; ++r) {
    for (int i = 0; i < samples; ++i) {
      weights_(r, static_cast<Eigen::Index>(draw() % static_cast<std::uint64_t>(samples))) +=
          1.0 / samples;
    }
  }
}

std::vector<MeanInterval> ResampledMeans::intervals(const Eigen::MatrixXd& values) const {
  std::vector<MeanInterval> found(static_cast<std::size_t>(values.cols()), {kNone, kNone, kNone});
  if (weights_.cols() == 0) return found;
  const Eigen::MatrixXd means = weights_ * values;
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    found[static_cast<std::size_t>(c)] = within(values.col(c).mean(), means.col(c));
  }
  return found;
}

MeanInterval ResampledMeans::interval(const Eigen::VectorXd& values) const {
  return intervals(values).front();
}

MeanInterval ResampledMeans::ratio(const Eigen::VectorXd& first,
                                   const Eigen::VectorXd& second) const {
  if (weights_.cols() == 0) return {kNone, kNone, kNone};
  return within(second.sum() / first.sum(), (weights_ * second).cwiseQuotient(weights_ * first));
}

double sign_flip_p(const Eigen::VectorXd& differences, int flips, std::uint64_t seed) {
  const double observed = std::abs(differences.sum());
  // Sums of the same numbers in another order differ by rounding.
  const double slack = 1e-12 * differences.cwiseAbs().sum();
  if (observed <= slack) return 1.0;
  std::mt19937_64 draw(seed);
  int as_far = 1;
  for (int f = 0; f < flips; ++f) {
    double sum = 0.0;
    std::uint64_t bits = 0;
    for (Eigen::Index i = 0; i < differences.size(); ++i) {
      if (i % 64 == 0) bits = draw();
      sum += (bits & 1U) != 0 ? differences[i] : -differences[i];
      bits >>= 1U;
    }
    as_far += std::abs(sum) >= observed - slack;
  }
  return static_cast<double>(as_far) / (flips + 1);
}

}  // namespace prospect
