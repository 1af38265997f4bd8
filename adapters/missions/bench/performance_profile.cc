// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/performance_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prospect {

double PerformanceProfile::at(double ratio) const {
  double share = 0.0;
  for (const Step& step : steps) {
    if (step.ratio <= ratio) share = step.share;
  }
  return share;
}

std::vector<PerformanceProfile> performance_profiles(
    const std::vector<std::vector<double>>& measures) {
  std::vector<PerformanceProfile> profiles(measures.size());
  if (measures.empty()) return profiles;
  const std::size_t problems = measures.front().size();
  std::vector<double> best(problems, std::numeric_limits<double>::infinity());
  for (const std::vector<double>& of_solver : measures) {
    for (std::size_t p = 0; p < problems; ++p) best[p] = std::min(best[p], of_solver[p]);
  }
  for (std::size_t s = 0; s < measures.size(); ++s) {
    std::vector<double> ratios;
    for (std::size_t p = 0; p < problems; ++p) {
      if (std::isfinite(measures[s][p])) ratios.push_back(measures[s][p] / best[p]);
    }
    std::sort(ratios.begin(), ratios.end());
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      if (i + 1 < ratios.size() && ratios[i + 1] == ratios[i]) continue;
      profiles[s].steps.push_back(
          {ratios[i], static_cast<double>(i + 1) / static_cast<double>(problems)});
    }
  }
  return profiles;
}

}  // namespace prospect
