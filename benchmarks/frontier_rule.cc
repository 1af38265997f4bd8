// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/frontier_rule.h"

#include <limits>

namespace prospect {

std::string_view to_string(FrontierRule rule) {
  return rule == FrontierRule::kNearest ? "nearest" : "cost-utility";
}

int choose_frontier(FrontierRule rule, const std::vector<FrontierCandidate>& candidates) {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const FrontierCandidate& c = candidates[k];
    const double cost = rule == FrontierRule::kNearest ? c.path : 3.0 * c.path - c.length;
    if (!(cost < least)) continue;
    least = cost;
    best = static_cast<int>(k);
  }
  return best;
}

FrontierPlannerOptions guided_by(FrontierRule rule, FrontierPlannerOptions options) {
  constexpr double kEvery = 3.0;  // [s]
  constexpr double kNever = 1e7;  // [s], longer than any mission
  options.rule = [rule](const std::vector<FrontierCandidate>& candidates, int) {
    return choose_frontier(rule, candidates);
  };
  options.reconsider = rule == FrontierRule::kNearest ? kNever : kEvery;
  options.resolved = 0.0;
  return options;
}

}  // namespace prospect
