// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

namespace prospect {

/// Predictions that fell between two tenths, and what became of them.
struct ReliabilityBin {
  double predicted = 0.0;  ///< mean of the predictions
  double observed = 0.0;   ///< share of them that came true
  int count = 0;
};

/// How far probabilities can be taken at their word: of all that was given p, a share p comes true.
struct Reliability {
  std::array<ReliabilityBin, 10> bins;  ///< [0, 0.1), [0.1, 0.2), ... [0.9, 1]
  int count = 0;
  double predicted = 0.0;  ///< mean of all predictions
  double observed = 0.0;   ///< share of all that came true
  double brier = 0.0;      ///< mean of (prediction - outcome)^2; Brier 1950
  /// sum_bins count |predicted - observed| / count of all: zero if calibrated, but for sampling.
  double error = 0.0;
};

/// Of predictions in [0, 1] and outcomes (0 or not), which are parallel. All zero without any.
/// Throws std::invalid_argument for sizes that differ and for predictions outside [0, 1].
Reliability reliability(const std::vector<double>& predicted, const std::vector<char>& outcome);

/// Predicted numbers against counted ones.
struct CountAgreement {
  int count = 0;                          ///< pairs
  double predicted = 0.0, counted = 0.0;  ///< means
  double bias = 0.0;                      ///< mean of predicted - counted
  double mean_absolute_error = 0.0;
  double correlation = 0.0;  ///< Pearson's; NaN if either does not vary or there are fewer than two
};

/// Throws std::invalid_argument for sizes that differ.
CountAgreement count_agreement(const std::vector<double>& predicted,
                               const std::vector<double>& counted);

}  // namespace prospect
