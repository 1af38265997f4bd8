// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "engine/frontiers/frontier_planner.h"

namespace prospect {

/// How a frontier planner chooses the one frontier it drives to next.
enum class FrontierRule {
  kNearest,     ///< the least distance; kept until that frontier is resolved
  kCostUtility  ///< the least 3 distance - 1 length; chosen anew every 3 s
};

std::string_view to_string(FrontierRule rule);

/// The candidate that the rule prefers, an index; -1 without candidates. Of equal ones the first.
/// A candidate's distance is its `way`.
///
/// kCostUtility is the cost of explore_lite, potential_scale distance - gain_scale size, with the
/// scales 3 and 1 of its published configurations. explore_lite measures the distance along a
/// straight line; here it is that of the path, as for kNearest, so that neither rule is drawn
/// through walls (our choice, in favour of the frontier planners).
int choose_frontier(FrontierRule rule, const std::vector<FrontierCandidate>& candidates);

/// `options` with the target chosen by that rule alone: turning costs nothing, and a target is kept
/// until it promises nothing any more.
FrontierPlannerOptions guided_by(FrontierRule rule, FrontierPlannerOptions options);

}  // namespace prospect
