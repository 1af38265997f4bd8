#include "benchmarks/frontier_rule.h"

#include <limits>

namespace prospect {

std::string_view to_string(FrontierRule rule) {
  return rule == FrontierRule::kNearest ? "nearest" : "cost-utility";
}

int choose_frontier(FrontierRule rule, const std::vector<FrontierOption>& options) {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const FrontierOption& option : options) {
    const double cost =
        rule == FrontierRule::kNearest ? option.distance : 3.0 * option.distance - option.length;
    if (!(cost < least)) continue;
    least = cost;
    best = option.frontier;
  }
  return best;
}

}  // namespace prospect
