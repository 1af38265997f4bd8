#pragma once

#include <string_view>
#include <vector>

namespace prospect {

/// How a frontier planner chooses the one frontier it drives to next.
enum class FrontierRule {
  kNearest,     ///< the least distance; kept until that frontier is resolved
  kCostUtility  ///< the least 3 distance - 1 length; chosen anew every 3 s
};

std::string_view to_string(FrontierRule rule);

/// What a rule knows about a frontier.
struct FrontierOption {
  int frontier = -1;      ///< index of the frontier
  double distance = 0.0;  ///< [m of path equivalent] to its best viewpoint, looking included
  double length = 0.0;    ///< [m]: number of its cells that count x resolution
};

/// The frontier that the rule prefers, -1 without options; of equal ones the first.
///
/// kCostUtility is the cost of explore_lite, potential_scale distance - gain_scale size, with the
/// scales 3 and 1 of its published configurations. explore_lite measures the distance along a
/// straight line; here it is that of the path, as for kNearest, so that neither rule is drawn
/// through walls (our choice, in favour of the frontier planners).
int choose_frontier(FrontierRule rule, const std::vector<FrontierOption>& options);

}  // namespace prospect
