// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/scale_agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "perception/odometry/median.h"

namespace prospect {

ScaleAgreement scale_agreement(std::vector<double> log_ratios, double expected, double systematic,
                               const ScaleAgreementOptions& options) {
  ScaleAgreement agreement;
  std::erase_if(log_ratios, [](double r) { return !std::isfinite(r); });
  agreement.samples = static_cast<int>(log_ratios.size());
  if (agreement.samples == 0) return agreement;
  const double m = median(log_ratios);
  for (double& r : log_ratios) r = std::abs(r - m);
  const double spread = 1.2533 * std::max(expected, 1.4826 * median(log_ratios));
  agreement.ratio = std::exp(m);
  agreement.sigma = std::hypot(systematic, spread / std::sqrt(agreement.samples));
  if (agreement.samples < options.least_samples) return agreement;
  const double limit = std::max(options.least, options.significance * agreement.sigma);
  agreement.verdict =
      std::abs(m) > limit ? ScaleAgreement::Verdict::kDisagree : ScaleAgreement::Verdict::kAgree;
  return agreement;
}

std::string to_string(const ScaleAgreement& agreement, std::string_view what,
                      std::string_view whose) {
  char numbers[96];
  std::snprintf(numbers, sizeof numbers, " %.3f times as long as ", agreement.ratio);
  std::string text = std::string(what) + numbers + std::string(whose);
  std::snprintf(numbers, sizeof numbers, ", +- %.1f %% (%d samples)", 100.0 * agreement.sigma,
                agreement.samples);
  return text + numbers;
}

}  // namespace prospect
