// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/feature_weight.h"

#include <algorithm>
#include <limits>

namespace prospect {

double feature_weight(const std::vector<WeighedCandidate>& candidates, double standing,
                      double most) {
  constexpr double kGoesOn = 0.5;  // share of the gain
  constexpr double kAhead = 0.1;   // share of the gain by which going on must be better
  double least = std::numeric_limits<double>::infinity();
  for (const WeighedCandidate& c : candidates) least = std::min(least, c.others);
  const double gain = standing - least;
  if (!(gain > 0.0) || candidates.empty()) return most;
  double weight = 0.0;
  for (const WeighedCandidate& i : candidates) {
    if (standing - i.others < kGoesOn * gain) continue;
    double bound = most;
    for (const WeighedCandidate& j : candidates) {
      if (standing - j.others >= kGoesOn * gain || j.features >= i.features) continue;
      bound = std::min(bound, (j.others - i.others - kAhead * gain) / (i.features - j.features));
    }
    weight = std::max(weight, bound);
  }
  return std::clamp(weight, 0.0, most);
}

double feature_weight(const std::vector<Candidate>& candidates, double most) {
  const auto standing = std::find_if(candidates.begin(), candidates.end(),
                                     [](const Candidate& c) { return c.stops && c.feasible(); });
  if (most <= 0.0 || standing == candidates.end()) return most;
  std::vector<WeighedCandidate> feasible;
  for (const Candidate& c : candidates) {
    if (c.feasible()) feasible.push_back({c.cost - most * c.features, c.features});
  }
  return feature_weight(feasible, standing->cost - most * standing->features, most);
}

}  // namespace prospect
