#include "adapters/study/paired_bootstrap.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

#include "engine/support/quantile.h"

namespace prospect {

Interval paired_bootstrap(const std::vector<double>& first, const std::vector<double>& second,
                          const PairedStatistic& statistic, int resamples, double level,
                          std::uint64_t seed) {
  if (first.size() != second.size() || resamples < 1 || !(level > 0.0 && level < 1.0)) {
    throw std::invalid_argument(
        "paired_bootstrap: expected as many first as second values, a resample or more, a level in "
        "(0, 1)");
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (first.empty()) return {kNone, kNone};
  // The remainder favours no pair by more than n / 2^64.
  std::mt19937_64 draw(seed);
  std::vector<double> a(first.size()), b(first.size()), values;
  for (int r = 0; r < resamples; ++r) {
    for (std::size_t i = 0; i < first.size(); ++i) {
      const std::size_t drawn = draw() % first.size();
      a[i] = first[drawn];
      b[i] = second[drawn];
    }
    const double value = statistic(a, b);
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.empty()) return {kNone, kNone};
  return {quantile(values, 0.5 * (1.0 - level)), quantile(values, 0.5 * (1.0 + level))};
}

double mean_difference(const std::vector<double>& first, const std::vector<double>& second) {
  double sum = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) sum += second[i] - first[i];
  return sum / static_cast<double>(first.size());
}

double ratio_of_means(const std::vector<double>& first, const std::vector<double>& second) {
  return std::accumulate(second.begin(), second.end(), 0.0) /
         std::accumulate(first.begin(), first.end(), 0.0);
}

}  // namespace prospect
