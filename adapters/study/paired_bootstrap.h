#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace prospect {

struct Interval {
  double low = 0.0, high = 0.0;
};

using PairedStatistic =
    std::function<double(const std::vector<double>& first, const std::vector<double>& second)>;

/// Percentile interval (B. Efron, 1979) of a statistic of pairs: of `resamples` samples of as many
/// pairs, drawn with replacement, the values between which a share `level` lies. Pairs stay
/// together. Values that are not finite (a ratio to nothing) are left out; NaN if none is left or
/// there are no pairs. Deterministic by `seed`. Throws std::invalid_argument for samples of
/// different lengths, resamples < 1 or a level outside (0, 1).
Interval paired_bootstrap(const std::vector<double>& first, const std::vector<double>& second,
                          const PairedStatistic& statistic, int resamples = 4000,
                          double level = 0.95, std::uint64_t seed = 1);

/// Mean of second - first.
double mean_difference(const std::vector<double>& first, const std::vector<double>& second);

/// Sum of second over sum of first: defined with zeros among them, as ratios of pairs are not.
double ratio_of_means(const std::vector<double>& first, const std::vector<double>& second);

}  // namespace prospect
