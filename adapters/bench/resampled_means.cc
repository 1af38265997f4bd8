#include "adapters/bench/resampled_means.h"

#include <cmath>
#include <limits>
#include <random>

#include "engine/support/quantile.h"

namespace prospect {

ResampledMeans::ResampledMeans(int problems, int resamples, std::uint64_t seed)
    : weights_(Eigen::MatrixXd::Zero(resamples, problems)) {
  if (problems < 1) return;
  // The remainder favours no problem by more than problems / 2^64.
  std::mt19937_64 draw(seed);
  for (int r = 0; r < resamples; ++r) {
    for (int i = 0; i < problems; ++i) {
      weights_(r, static_cast<Eigen::Index>(draw() % static_cast<std::uint64_t>(problems))) +=
          1.0 / problems;
    }
  }
}

std::vector<MeanInterval> ResampledMeans::intervals(const Eigen::MatrixXd& values) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<MeanInterval> found(static_cast<std::size_t>(values.cols()), {kNone, kNone, kNone});
  if (weights_.cols() == 0) return found;
  const Eigen::MatrixXd means = weights_ * values;
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    const std::vector<double> all(means.col(c).begin(), means.col(c).end());
    found[static_cast<std::size_t>(c)] = {values.col(c).mean(), quantile(all, 0.025),
                                          quantile(all, 0.975)};
  }
  return found;
}

MeanInterval ResampledMeans::interval(const Eigen::VectorXd& values) const {
  return intervals(values).front();
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
